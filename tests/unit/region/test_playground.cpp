// The default world, split over its four servers, plays as it does on one.
#include <deque>
#include <map>

#include "server/worlds/world_file.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

WorldDefinition playground(std::optional<int> regions) {
  auto world = load_world("playground", {regions});
  if (!world) throw std::runtime_error(world.error().message);
  return std::move(*world);
}

const BodyGroup& group(const WorldDefinition& world, const std::string& name) {
  for (const BodyGroup& g : world.body_groups)
    if (g.name == name) return g;
  throw std::runtime_error("the playground has no " + name);
}

}  // namespace

TEST_CASE("the domino ring topples through all four regions, in order, and no slower than in one") {
  std::vector<std::vector<int>> fell;
  for (const std::optional<int> regions : {std::optional<int>(1), std::optional<int>()}) {
    WorldDefinition world = playground(regions);
    const BodyGroup ring = group(world, "domino ring");
    BodyState& first = world.bodies[ring.first].state;
    first.activation = Activation::awake;
    first.linear_velocity = first.orientation * Eigen::Vector3f(1, 0, 0);
    first.angular_velocity = first.orientation * Eigen::Vector3f(0, 0, -2);
    RegionCluster cluster(world, regions ? 0 : 1);
    auto& times = fell.emplace_back(ring.count, -1);
    for (int tick = 0; tick < 40 * 63; ++tick) {
      cluster.step();
      for (std::uint32_t i = 0; i < ring.count; ++i) {
        const BodyId id = BodyId::world(ring.first + i);
        if (times[i] >= 0 || !cluster.owner(id)) continue;
        const Eigen::Vector3f up = cluster.state(id).orientation * Eigen::Vector3f::UnitY();
        if (up.y() < 0.7f) times[i] = tick;
      }
    }
    REQUIRE(cluster.bodies_in_world() == world.bodies.size());
    REQUIRE(cluster.faults().empty());
  }
  for (std::size_t i = 0; i < fell[0].size(); ++i) {
    INFO("domino " << i << ": tick " << fell[0][i] << " on one server, " << fell[1][i]
                   << " on four");
    REQUIRE(fell[0][i] >= 0);
    REQUIRE(fell[1][i] >= 0);
    if (i > 0) REQUIRE(fell[1][i] >= fell[1][i - 1]);
    // A chain amplifies the smallest difference; half a second after 20 s of toppling is a tick
    // in 40.
    REQUIRE(std::abs(fell[1][i] - fell[0][i]) <= 32);
  }
}

TEST_CASE("the playground comes to rest by itself and then owners change no more") {
  const WorldDefinition world = playground({});
  RegionCluster cluster(world, 1);
  cluster.step(600);
  const auto migrations = [&] {
    std::uint64_t all = 0;
    for (int i = 0; i < 4; ++i) all += cluster.core(i).statistics().migrations_in;
    return all;
  };
  const auto before = migrations();
  cluster.step(300);
  REQUIRE(migrations() == before);
  for (int i = 0; i < 4; ++i) {
    REQUIRE(cluster.core(i).statistics().awake == 0);
    REQUIRE(cluster.core(i).statistics().version_conflicts == 0);
  }
  REQUIRE(cluster.store().size() == world.bodies.size());
}

TEST_CASE("a blast at the four-way corner moves bodies of all four regions") {
  auto world = flat_world(1);
  const double inf = std::numeric_limits<double>::infinity();
  world.regions = {{"a", {-inf, -inf, 0, 0}},
                   {"b", {0, -inf, inf, 0}},
                   {"c", {-inf, 0, 0, inf}},
                   {"d", {0, 0, inf, inf}}};
  world.spawn_points = {{{-0.5, 0.95, -0.5}, 0}};
  std::vector<BodyId> balls;
  for (const double x : {-4.0, 4.0})
    for (const double z : {-4.0, 4.0}) balls.push_back(put(world, ball, {x, 0.3, z}));
  RegionCluster cluster(world, 1);
  PlayerCommand command;
  command.player = PlayerId{5};
  command.session = 1;
  command.sequence = 1;
  command.kind = PlayerCommand::Kind::join;
  cluster.command(command, 0);
  cluster.step(60);
  for (std::size_t i = 0; i < 4; ++i) REQUIRE(cluster.owner(balls[i]));
  command.sequence = 2;
  command.kind = PlayerCommand::Kind::blast;
  cluster.command(command);
  cluster.step(20);
  for (BodyId id : balls) {
    const BodyState state = cluster.state(id);
    REQUIRE(std::hypot(state.position.x, state.position.z) > 5.9);
  }
}

TEST_CASE(
    "while the tower on the corner is shot to pieces nobody changes owner more than twice a "
    "second") {
  WorldDefinition world = playground({});
  // Heavy balls from two sides, one after the other, into the tower that stands on all four
  // regions.
  const PrototypeId heavy = world.throwables[1].prototype;
  for (int i = 0; i < 12; ++i) {
    const float side = i % 2 ? 1.0f : -1.0f;
    put(world, heavy, {side * (9.0 + 5 * i), 1.5 + 0.1 * i, 0.4 * (i % 5) - 0.8},
        {-side * 22.0f, 1.0f + 0.6f * static_cast<float>(i), 0});
  }
  for (const int delay : {0, 1}) {
    RegionCluster cluster(world, delay);
    std::map<BodyId, int> owners;
    std::map<BodyId, std::deque<Tick>> changes;
    std::size_t most = 0, moves = 0;
    for (int n = 0; n < 500; ++n) {
      cluster.step();
      for (int i = 0; i < 4; ++i) {
        for (BodyId id : cluster.core(i).physics().ids()) {
          const auto [it, fresh] = owners.try_emplace(id, i);
          if (it->second == i) continue;
          it->second = i;
          // The world is cut while it sleeps; what touches over a seam is first brought together.
          if (n < 30) continue;
          auto& recent = changes[id];
          recent.push_back(cluster.now());
          while (cluster.now() - recent.front() >= 63) recent.pop_front();
          most = std::max(most, recent.size());
          ++moves;
        }
      }
      REQUIRE(cluster.bodies_in_world() == world.bodies.size());
    }
    INFO("delay " << delay << ": " << moves << " changes of owner, at most " << most
                  << " a second");
    CHECK(moves > 0);
    CHECK(most <= 2);
  }
}
