// The worlds that are shipped: they load, what is declared asleep is at rest, and the dominoes
// fall.
#include <map>
#include <set>

#include "server/physics/physics_world.h"
#include "server/worlds/injector.h"
#include "tests/support/catch.h"
#include "tests/unit/worlds/small_world.h"

namespace aureole::test {
namespace {

const std::vector<std::string> shipped = {"playground", "columns-4", "corner-3", "corner-4",
                                          "corner-9"};

WorldDefinition loaded(const std::string& name) {
  auto world = load_world(name);
  INFO((world ? "" : world.error().message));
  REQUIRE(world);
  return *std::move(world);
}

/// Prototypes and statics in the form that physics wants, and the world made of them.
struct Simulation {
  explicit Simulation(const WorldDefinition& world) {
    for (const Prototype& p : world.prototypes) prototypes.push_back(p.body);
    for (const WorldStatic& s : world.statics) statics.push_back(s.body);
    physics.emplace(world.physics, prototypes, statics);
  }
  std::vector<BodyDefinition> prototypes;
  std::vector<StaticDefinition> statics;
  std::optional<PhysicsWorld> physics;
};

const BodyGroup& group(const WorldDefinition& world, const std::string& name) {
  for (const BodyGroup& g : world.body_groups) {
    if (g.name == name) return g;
  }
  FAIL("no group " << name);
  return world.body_groups.front();
}

}  // namespace

TEST_CASE("every shipped world loads, and as 1, 2, 4 and 9 regions too") {
  for (const std::string& name : shipped) {
    INFO(name);
    CHECK(loaded(name).name == name);
    for (int n : {1, 2, 3, 4, 9}) {
      const auto world = load_world(name, {n});
      INFO((world ? "" : world.error().message));
      REQUIRE(world);
      CHECK(world->regions.size() == static_cast<std::size_t>(n));
    }
  }
}

TEST_CASE("the playground has several hundred bodies, most of them asleep, in all four regions") {
  const WorldDefinition world = loaded("playground");
  CHECK(world.bodies.size() >= 600);
  CHECK(world.bodies.size() <= 900);
  std::map<std::uint16_t, int> in_region;
  std::size_t asleep = 0;
  for (const WorldBody& b : world.bodies) {
    ++in_region[region_at(world.regions, b.state.position.x, b.state.position.z).value];
    asleep += b.state.activation == Activation::asleep;
  }
  for (std::uint16_t r = 0; r < 4; ++r) CHECK(in_region[r] > 80);
  CHECK(asleep + 10 > world.bodies.size());
}

TEST_CASE(
    "what a shipped world declares asleep is at rest: three seconds awake move nothing by 3 cm") {
  for (const std::string& name : shipped) {
    const WorldDefinition world = loaded(name);
    Simulation simulation(world);
    std::vector<NewBody> bodies;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      if (world.bodies[i].state.activation != Activation::asleep) continue;
      NewBody b{BodyId::world(static_cast<std::uint32_t>(i)), world.bodies[i].prototype,
                world.bodies[i].state};
      b.state.activation = Activation::awake;
      b.state.deactivation_time_s = 0;
      bodies.push_back(b);
    }
    simulation.physics->add(bodies);
    for (int i = 0; i < 188; ++i) simulation.physics->step(tick_s);
    std::map<std::string, double> moved;
    for (const NewBody& b : bodies) {
      std::string where = "?";
      const auto index = static_cast<std::uint32_t>(b.id.value & 0xffff'ffffu);
      for (const BodyGroup& g : world.body_groups) {
        if (index >= g.first && index < g.first + g.count) where = g.name;
      }
      double& most = moved[where];
      most = std::max(most, distance(simulation.physics->position(b.id), b.state.position));
    }
    for (const auto& [where, metres] : moved) {
      INFO(name << ": " << where);
      CHECK(metres < 0.03);
    }
  }
}

TEST_CASE("the domino ring topples to its end, in order, when the first is pushed") {
  const WorldDefinition world = loaded("playground");
  Simulation simulation(world);
  const BodyGroup& ring = group(world, "domino ring");
  std::vector<NewBody> bodies;
  std::set<std::uint16_t> regions;
  for (std::uint32_t i = ring.first; i < ring.first + ring.count; ++i) {
    const BodyState& state = world.bodies[i].state;
    bodies.push_back({BodyId::world(i), world.bodies[i].prototype, state});
    regions.insert(region_at(world.regions, state.position.x, state.position.z).value);
  }
  CHECK(regions.size() == 4);
  PhysicsWorld& physics = *simulation.physics;
  physics.add(bodies);
  const BodyState& first = bodies.front().state;
  physics.set_velocity(bodies.front().id, first.orientation * Eigen::Vector3f(1, 0, 0),
                       first.orientation * Eigen::Vector3f(0, 0, -2));
  std::vector<int> fell(bodies.size(), -1);
  for (int tick = 0; tick < 40 * 63; ++tick) {
    physics.step(tick_s);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Eigen::Vector3f up = physics.state(bodies[i].id).orientation * Eigen::Vector3f::UnitY();
      // Past 45°: a domino that leans that far does not come back.
      if (fell[i] < 0 && up.y() < 0.7f) fell[i] = tick;
    }
  }
  for (std::size_t i = 0; i < fell.size(); ++i) {
    INFO("domino " << i << " of " << fell.size());
    REQUIRE(fell[i] >= 0);
    if (i > 0) CHECK(fell[i] >= fell[i - 1]);
  }
}

TEST_CASE(
    "the paper's worlds inject 9,600 bodies in 60 s, half beside boundaries, half at centres") {
  for (const char* name : {"columns-4", "corner-3", "corner-4", "corner-9"}) {
    INFO(name);
    const WorldDefinition world = loaded(name);
    std::uint64_t beside = 0, centre = 0;
    double rate = 0;
    for (const Injector& i : world.injectors) {
      (i.name.starts_with("boundary") ? beside : centre) += injected_count(i, Tick{3750});
      rate += i.rate_per_s;
      CHECK(injected_count(i, Tick{100'000}) == injected_count(i, Tick{3750}));
      CHECK(i.velocity_min == Eigen::Vector3f(-10, -10, -10));
      CHECK(i.velocity_max == Eigen::Vector3f(10, 0, 10));
      CHECK((i.volume.min.y() + i.volume.max.y()) / 2 == 15);
    }
    CHECK(beside == 4800);
    CHECK(centre == 4800);
    CHECK(rate == Approx(160));
    CHECK(world.tolerances.speed_mps == 32);
    CHECK(world.tolerances.latency_ms == 2);
    CHECK(world.tolerances.frame_time_ms == 15);
  }
}

}  // namespace aureole::test
