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

}  // namespace

TEST_CASE("two balls that fly at each other over a boundary bounce off as on one server") {
  auto whole = flat_world(1), split = flat_world(2, 50);
  BodyId a, b;
  for (auto* world : {&whole, &split}) {
    a = put(*world, ball, {46, 5, 0}, {10, 0, 0});
    b = put(*world, ball, {54, 5, 0}, {-10, 0, 0});
    world->prototypes[0].body.restitution = 1;
  }
  for (const int delay : {0, 1, 2}) {
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
  RegionCluster two(split, 0, MigrationMode::naive);
  two.step(28);
  REQUIRE(two.state(a).linear_velocity.x() > 5);
}

TEST_CASE("a sleeping wall across a boundary is brought together before anyone can strike it") {
  auto world = flat_world(2, 50);
  std::vector<BodyId> wall;
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < 6; ++i)
      wall.push_back(put(world, box, {47.5 + i + 0.5 * (row % 2), 0.5 + row, 0}, {0, 0, 0},
                         Activation::asleep));
  RegionCluster cluster(world, 1);
  cluster.step(12);
  for (BodyId id : wall) {
    REQUIRE(cluster.owner(id) == cluster.owner(wall[0]));
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
        wall.push_back(put(*world, box, {50.6, 0.5 + row, -1.0 + i}, {0, 0, 0}, Activation::asleep));
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
  auto whole = flat_world(1);
  auto split = whole;
  split.regions.clear();
  const double inf = std::numeric_limits<double>::infinity();
  split.regions = {{"a", {-inf, -inf, 0, 0}}, {"b", {0, -inf, inf, 0}},
                   {"c", {-inf, 0, 0, inf}}, {"d", {0, 0, inf, inf}}};
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
  cluster.step(6);
  REQUIRE(cluster.owner(wanderer) == 1);
  REQUIRE(cluster.owner(companion) == 1);
  REQUIRE(cluster.core(0).statistics().migrations_out == 2);
}

TEST_CASE("a cluster with a member at home is no island") {
  auto world = flat_world(2, 50);
  const BodyId at_home = put(world, box, {49.6, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId across = put(world, box, {50.6, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  for (auto& body : world.bodies) body.host = RegionId{0};
  RegionCluster cluster(world, 1);
  cluster.step(100);
  REQUIRE(cluster.owner(at_home) == 0);
  REQUIRE(cluster.owner(across) == 0);
}

TEST_CASE("two servers that see the same overlap do not swap their bodies for ever") {
  auto world = flat_world(2, 50);
  const BodyId a = put(world, ball, {49.4, 0.3, 0}, {1, 0, 0});
  const BodyId b = put(world, ball, {50.6, 0.3, 0}, {-1, 0, 0});
  RegionCluster cluster(world, 1);
  REQUIRE(step_until(cluster, 30, [&] {
    return cluster.owner(a) && cluster.owner(a) == cluster.owner(b);
  }));
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
