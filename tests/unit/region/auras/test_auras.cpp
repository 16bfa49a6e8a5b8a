// Bodies of two servers meet as if there were only one: aura projection in small scripted scenes.
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

/// Steps until `done`, at most `limit` ticks. False if that never came.
template <class Done>
bool step_until(RegionCluster& cluster, int limit, Done done) {
  for (int i = 0; i < limit; ++i) {
    if (done()) return true;
    cluster.step();
  }
  return done();
}

/// Four regions around a corner at the origin.
WorldDefinition four_way_world() {
  WorldDefinition world = flat_world(1);
  const double inf = std::numeric_limits<double>::infinity();
  world.regions = {{"a", {-inf, -inf, 0, 0}},
                   {"b", {0, -inf, inf, 0}},
                   {"c", {-inf, 0, 0, inf}},
                   {"d", {0, 0, inf, inf}}};
  return world;
}

}  // namespace

TEST_CASE("two balls that fly at each other over a boundary bounce off as on one server") {
  auto whole = flat_world(1), split = flat_world(2, 50);
  BodyId a, b;
  for (auto* world : {&whole, &split}) {
    a = put(*world, ball, {46, 5, 0}, {10, 0, 0});
    b = put(*world, ball, {54, 5, 0}, {-10, 0, 0});
    world->prototypes[0].body.restitution = 1;
  }
  // At most two steps, as long as the tolerances give a message.
  for (const int delay : {0, 1}) {
    RegionCluster one(whole), two(split, delay);
    one.step(40);
    two.step(40);
    REQUIRE(one.state(a).linear_velocity.x() < -5);
    REQUIRE(two.owner(a));
    REQUIRE(two.owner(a) == two.owner(b));
    REQUIRE((two.state(a).linear_velocity - one.state(a).linear_velocity).norm() < 0.05f);
    REQUIRE((two.state(b).linear_velocity - one.state(b).linear_velocity).norm() < 0.05f);
  }
}

TEST_CASE("without auras the same two balls pass through each other") {
  auto split = flat_world(2, 50);
  const BodyId a = put(split, ball, {46, 5, 0}, {10, 0, 0});
  put(split, ball, {54, 5, 0}, {-10, 0, 0});
  split.prototypes[0].body.restitution = 1;
  split.mode = MigrationMode::naive;
  RegionCluster two(split);
  two.step(28);
  REQUIRE(two.state(a).linear_velocity.x() > 5);
}

TEST_CASE("a sleeping wall across a boundary is cut there, and nobody stirs") {
  auto world = flat_world(2, 50);
  std::vector<BodyId> wall;
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 6; ++i)
      wall.push_back(put(world, box, {47.5 + i + 0.5 * (row % 2), 0.5 + row, 0}, {0, 0, 0},
                         Activation::asleep));
  RegionCluster cluster(world, 1);
  cluster.step(12);
  for (BodyId id : wall) {
    REQUIRE(cluster.owner(id) == (cluster.state(id).position.x < 50 ? 0 : 1));
    REQUIRE(cluster.state(id).activation == Activation::asleep);
  }
  // Then nothing moves any more, neither bodies nor owners.
  std::uint64_t before = 0, after = 0;
  for (int i = 0; i < 2; ++i) before += cluster.core(i).statistics().migrations_in;
  cluster.step(200);
  for (int i = 0; i < 2; ++i) after += cluster.core(i).statistics().migrations_in;
  REQUIRE(before == after);
}

TEST_CASE("a ball thrown at a wall that the neighbour hosts knocks it over as on one server") {
  auto whole = flat_world(1), split = flat_world(2, 50);
  BodyId thrown;
  std::vector<BodyId> wall;
  for (auto* world : {&whole, &split}) {
    wall.clear();
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < 3; ++i)
        wall.push_back(
            put(*world, box, {50.6, 0.5 + row, -1.0 + i}, {0, 0, 0}, Activation::asleep));
    thrown = put(*world, ball, {40, 1.6, 0}, {20, 1, 0});
    world->prototypes[0].body.mass_kg = 8;
  }
  RegionCluster one(whole), two(split, 1);
  one.step(150);
  two.step(150);
  int fallen_one = 0, fallen_two = 0;
  for (BodyId id : wall) {
    fallen_one += one.state(id).position.x > 51;
    fallen_two += two.state(id).position.x > 51;
  }
  REQUIRE(fallen_one >= 2);
  REQUIRE(std::abs(fallen_one - fallen_two) <= 1);
}

TEST_CASE("dominoes fall in order over a four-way corner, as on one server") {
  auto whole = flat_world(1), split = four_way_world();
  std::vector<BodyId> line;
  for (auto* world : {&whole, &split}) {
    world->prototypes[1].body.shape = BoxShape{{0.06f, 0.5f, 0.25f}};
    line.clear();
    for (int i = -12; i <= 12; ++i) {
      // Along the diagonal through the corner.
      WorldBody body;
      body.prototype = box;
      body.state.position = {0.32 * i + 0.05, 0.5, 0.32 * i + 0.02};
      body.state.orientation =
          Eigen::Quaternionf(Eigen::AngleAxisf(-0.785398f, Eigen::Vector3f::UnitY()));
      body.state.activation = Activation::asleep;
      if (i == -12) {
        body.state.activation = Activation::awake;
        body.state.angular_velocity = {1.8f, 0, -1.8f};
      }
      world->bodies.push_back(body);
      line.push_back(BodyId::world(static_cast<std::uint32_t>(world->bodies.size() - 1)));
    }
  }
  const auto fall_times = [&](RegionCluster& cluster) {
    std::vector<std::int64_t> times(line.size(), -1);
    for (int t = 0; t < 400; ++t) {
      cluster.step();
      for (std::size_t i = 0; i < line.size(); ++i)
        if (times[i] < 0 && cluster.owner(line[i]) && cluster.state(line[i]).position.y < 0.42)
          times[i] = t;
    }
    return times;
  };
  RegionCluster one(whole);
  const auto expected = fall_times(one);
  for (const int delay : {0, 1}) {
    RegionCluster four(split, delay);
    const auto times = fall_times(four);
    for (std::size_t i = 0; i < line.size(); ++i) {
      INFO("domino " << i);
      REQUIRE(expected[i] >= 0);
      REQUIRE(times[i] >= 0);
      REQUIRE(std::abs(times[i] - expected[i]) <= 12);
      if (i > 0) REQUIRE(times[i] >= times[i - 1]);
    }
    REQUIRE(four.bodies_in_world() == line.size());
  }
}

TEST_CASE("bodies that rest apart on either side of a boundary stay with their own servers") {
  auto world = flat_world(2, 50);
  const BodyId left = put(world, box, {49.2, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId right = put(world, box, {50.8, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world, 1);
  cluster.step(100);
  REQUIRE(cluster.owner(left) == 0);
  REQUIRE(cluster.owner(right) == 1);
}

TEST_CASE("an island goes home once it has come to rest, and only then") {
  auto world = flat_world(2, 50);
  const BodyId wanderer = put(world, box, {55, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId companion = put(world, box, {56.05, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  for (auto& body : world.bodies) body.host = RegionId{0};
  RegionCluster cluster(world, 1);
  cluster.step(14);
  REQUIRE(cluster.owner(wanderer) == 1);
  REQUIRE(cluster.owner(companion) == 1);
  REQUIRE(cluster.core(0).statistics().migrations_out == 2);
}

TEST_CASE("a moving cluster with a member at home is no island") {
  auto world = flat_world(2, 50);
  const BodyId at_home = put(world, ball, {49.3, 0.3, 0}, {0.4, 0, 0});
  const BodyId across = put(world, ball, {50.6, 0.3, 0}, {0.4, 0, 0});
  for (auto& prototype : world.prototypes) prototype.body.linear_damping = 0;
  for (auto& body : world.bodies) body.host = RegionId{0};
  RegionCluster cluster(world, 1);
  cluster.step(70);
  REQUIRE(cluster.owner(at_home) == 0);
  REQUIRE(cluster.owner(across) == 1);
  for (auto& body : world.bodies) body.state.position.x = body.state.position.x < 50 ? 49.7 : 50.3;
  RegionCluster touching(world, 1);
  touching.step(16);
  REQUIRE(touching.owner(at_home) == 0);
  REQUIRE(touching.owner(across) == 0);
}

TEST_CASE("two servers that see the same overlap do not swap their bodies for ever") {
  auto world = flat_world(2, 50);
  const BodyId a = put(world, ball, {49.4, 0.3, 0}, {1, 0, 0});
  const BodyId b = put(world, ball, {50.6, 0.3, 0}, {-1, 0, 0});
  RegionCluster cluster(world, 1);
  REQUIRE(step_until(cluster, 30,
                     [&] { return cluster.owner(a) && cluster.owner(a) == cluster.owner(b); }));
  std::uint64_t moves = 0;
  cluster.step(300);
  for (int i = 0; i < 2; ++i) moves += cluster.core(i).statistics().migrations_in;
  REQUIRE(moves <= 4);
  REQUIRE(cluster.owner(a));
  REQUIRE(cluster.owner(b));
}

TEST_CASE("after a reset of the link auras are told again and the meeting still happens") {
  auto world = flat_world(2, 50);
  const BodyId a = put(world, ball, {44, 5, 0}, {10, 0, 0});
  const BodyId b = put(world, ball, {56, 5, 0}, {-10, 0, 0});
  world.prototypes[0].body.restitution = 1;
  RegionCluster cluster(world, 1);
  cluster.step(10);
  cluster.reset_link(0, 1);
  cluster.step(50);
  REQUIRE(cluster.owner(a) == cluster.owner(b));
  REQUIRE(cluster.state(a).linear_velocity.x() < -3);
}

TEST_CASE("four balls of four regions meet at the corner and bounce off as on one server") {
  auto whole = flat_world(1), split = four_way_world();
  std::vector<BodyId> balls;
  for (auto* world : {&whole, &split}) {
    balls.clear();
    for (const double x : {-3.0, 3.0})
      for (const double z : {-3.0, 3.0})
        balls.push_back(put(*world, ball, {x, 20, z},
                            {static_cast<float>(-2 * x), 0, static_cast<float>(-2 * z)}));
    world->prototypes[0].body.restitution = 1;
  }
  for (const int delay : {0, 1, 2}) {
    RegionCluster one(whole), four(split, delay);
    one.step(45);
    four.step(45);
    for (BodyId id : balls) {
      INFO("delay " << delay << ", ball " << id.value);
      REQUIRE(four.owner(id));
      REQUIRE(one.state(id).linear_velocity.x() * one.state(id).position.x > 0);
      REQUIRE((four.state(id).linear_velocity - one.state(id).linear_velocity).norm() < 0.2f);
    }
    REQUIRE(four.bodies_in_world() == 4);
  }
}

TEST_CASE("what is struck strikes on, over the boundary, as on one server") {
  struct Row {
    double from_x, gap_m;
    float speed_mps;
  };
  for (const Row& r : {Row{48, 0.9, 15}, Row{48.6, 0.9, 15}, Row{49.9, 1.2, 8}}) {
    auto whole = flat_world(1), split = flat_world(2, 50);
    std::vector<BodyId> row;
    for (auto* world : {&whole, &split}) {
      world->prototypes[0].body.restitution = 1;
      world->prototypes[0].body.friction = 0;
      row = {put(*world, ball, {r.from_x - 5, 0.3, 0}, {r.speed_mps, 0, 0})};
      for (int i = 0; i < 5; ++i)
        row.push_back(
            put(*world, ball, {r.from_x + r.gap_m * i, 0.3, 0}, {0, 0, 0}, Activation::asleep));
    }
    for (const int delay : {0, 1}) {
      RegionCluster one(whole), two(split, delay);
      // Until the last one has been struck and rolled on for three metres.
      const int ticks = static_cast<int>((8 + 5 * r.gap_m) / (r.speed_mps * tick_s));
      one.step(ticks);
      two.step(ticks);
      // One that is on its way just now is looked at once it is there.
      const auto in_flight = [&](BodyId id) { return !two.owner(id); };
      while (std::any_of(row.begin(), row.end(), in_flight)) {
        one.step();
        two.step();
      }
      for (std::size_t i = 0; i < row.size(); ++i) {
        INFO("from " << r.from_x << " m, delay " << delay << ", ball " << i);
        REQUIRE(std::abs(one.state(row[i]).position.x - two.state(row[i]).position.x) < 0.3);
      }
    }
  }
}

TEST_CASE(
    "who steps to and fro in front of a neighbour's body is brought together with it and stays") {
  auto world = flat_world(2, 50);
  world.spawn_points[0].position = {52.28, 0.95, 0};
  const BodyId still = put(world, box, {49.2, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world, 1);
  PlayerCommand command;
  command.player = PlayerId{5};  // Stands 0.64 m before the spawn point.
  command.session = 1;
  command.sequence = 1;
  command.kind = PlayerCommand::Kind::join;
  cluster.command(command, 1);
  cluster.step(60);
  command.kind = PlayerCommand::Kind::input;
  command.yaw = 1.5708f;  // West.
  int changes = 0;
  std::map<BodyId, int> owners{{BodyId::avatar(command.player), 1}, {still, 0}};
  for (int t = 0; t < 600; ++t) {
    for (auto& [body, owner] : owners) {
      const auto now = cluster.owner(body);
      if (!now || *now == owner) continue;
      owner = *now;
      ++changes;
    }
    const bool here = cluster.owner(BodyId::avatar(command.player)).has_value();
    if (here && t % 18 == 0) {
      command.keys = t / 18 % 2 == 0 ? keys::forward : keys::back;
      ++command.sequence;
      cluster.command(command);
    }
    cluster.step();
  }
  // Whoever is about keeps what is in reach: one change of owner in ten seconds, not one at each
  // turn.
  REQUIRE(changes == 1);
}
