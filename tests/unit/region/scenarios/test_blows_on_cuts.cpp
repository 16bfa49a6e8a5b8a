// What rests may be cut: hunting for blows that reach a stand-in before both sides are together.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/scenarios/overlap_watch.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

std::uint64_t struck(RegionCluster& cluster, const WorldDefinition& world) {
  std::uint64_t all = 0;
  for (int i = 0; i < static_cast<int>(world.regions.size()); ++i)
    all += cluster.core(i).statistics().struck_stand_ins;
  return all;
}

std::uint64_t stand_ins(RegionCluster& cluster, const WorldDefinition& world) {
  std::uint64_t all = 0;
  for (int i = 0; i < static_cast<int>(world.regions.size()); ++i)
    all += cluster.core(i).statistics().stand_ins;
  return all;
}

void into_four(WorldDefinition& world) {
  world.regions = {{"a", {-inf, -inf, 0, 0}},
                   {"b", {0, -inf, inf, 0}},
                   {"c", {-inf, 0, 0, inf}},
                   {"d", {0, 0, inf, inf}}};
}

/// Steps to the tick given, or a little further until nobody is in flight. In no tick may bodies of
/// two servers be in each other.
void step_to(RegionCluster& cluster, const WorldDefinition& world, int ticks,
             std::span<const BodyId> ids) {
  OverlapWatch watch(world);
  const auto in_flight = [&](BodyId id) { return !cluster.owner(id); };
  for (int tick = 0; tick < ticks + 20; ++tick) {
    if (tick >= ticks && std::none_of(ids.begin(), ids.end(), in_flight)) break;
    cluster.step();
    watch.look(cluster, world);
  }
  INFO("deepest: " << watch.worst());
  CHECK(watch.overlaps() == 0);
}

/// Everything of the world that rests is cut and stands still.
void require_cut(RegionCluster& cluster, const WorldDefinition& world, int ticks) {
  cluster.step(ticks);
  REQUIRE(stand_ins(cluster, world) > 0);
  for (int i = 0; i < static_cast<int>(world.regions.size()); ++i)
    REQUIRE(cluster.core(i).statistics().migrations_out == 0);
}

/// Of bodies of 1 kg.
double row_momentum_mps(RegionCluster& cluster, std::span<const BodyId> row) {
  double sum = 0;
  for (BodyId id : row) sum += double{cluster.state(id).linear_velocity.x()};
  return sum;
}

}  // namespace

TEST_CASE("a fast ball into the far end of a row across a boundary moves it as on one server") {
  for (const int count : {4, 10, 16})
    for (const float speed : {5.f, 20.f, 30.f})
      for (const double first : {49.7, 48.0, 46.0, 44.0}) {
        auto whole = flat_world(1), split = flat_world(2, 50);
        std::vector<BodyId> row;
        for (auto* world : {&whole, &split}) {
          world->prototypes[0].body.friction = 0;
          row = {put(*world, ball, {first - 0.6 - speed * 1.0, 0.3, 0}, {speed, 0, 0})};
          for (int i = 0; i < count; ++i)
            row.push_back(
                put(*world, ball, {first + 0.6 * i, 0.3, 0}, {0, 0, 0}, Activation::asleep));
        }
        RegionCluster one(whole);
        one.step(100);
        const double expected_mps = row_momentum_mps(one, row);
        for (const int delay : {0, 1}) {
          RegionCluster two(split, delay);
          INFO("row of " << count << " from " << first << ", " << speed << " m/s, delay " << delay);
          step_to(two, split, 100, row);
          CHECK(struck(two, split) == 0);
          // How the balls share it depends on the order in which the solver meets them; how much
          // there is does not.
          CHECK(std::abs(row_momentum_mps(two, row) - expected_mps) < 0.1 * double{speed});
          int unmoved = 0, out_of_order = 0;
          for (std::size_t i = 1; i < row.size(); ++i) {
            const double x = two.state(row[i]).position.x;
            const double began = first + 0.6 * static_cast<double>(i - 1);
            const bool moved_alone = std::abs(one.state(row[i]).position.x - began) > 0.05;
            unmoved += moved_alone && std::abs(x - began) < 0.01;
            out_of_order += x < two.state(row[i - 1]).position.x;
          }
          CHECK(unmoved == 0);
          CHECK(out_of_order == 0);
        }
      }
}

TEST_CASE("a tower on the boundary falls when its foot is struck, and no stand-in is hit") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(2, 50);
    std::vector<BodyId> tower;
    for (int level = 0; level < 8; ++level)
      for (const double x : {49.5, 50.5})
        tower.push_back(put(world, box, {x, 0.5 + level, 0}, {0, 0, 0}, Activation::asleep));
    world.prototypes[0].body.mass_kg = 20;
    put(world, ball, {20, 0.6, 0}, {25, 1.5f, 0});
    RegionCluster cluster(world, delay);
    require_cut(cluster, world, 50);
    INFO("delay " << delay);
    step_to(cluster, world, 200, tower);
    CHECK(struck(cluster, world) == 0);
    int fallen = 0;
    for (std::size_t i = 0; i < tower.size(); ++i)
      fallen += cluster.state(tower[i]).position.y < 0.4 + static_cast<double>(i / 2);
    CHECK(fallen > 4);
  }
}

TEST_CASE("a wall of 200 bricks along the boundary is hit in the middle") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(2, 50);
    world.prototypes[2].body.shape = BoxShape{{0.25f, 0.15f, 0.5f}};
    std::vector<BodyId> wall;
    for (int level = 0; level < 10; ++level)
      for (int i = 0; i < 20; ++i)
        wall.push_back(
            put(world, plank,
                {50.0 + 0.1 * (i % 3 - 1), 0.15 + 0.3 * level, 1.0 * i - 10 + 0.5 * (level % 2)},
                {0, 0, 0}, Activation::asleep));
    world.prototypes[0].body.mass_kg = 10;
    put(world, ball, {20, 2.0, 0.2}, {25, 5.5f, 0});
    RegionCluster cluster(world, delay);
    require_cut(cluster, world, 50);
    INFO("delay " << delay);
    step_to(cluster, world, 250, wall);
    CHECK(struck(cluster, world) == 0);
    int moved = 0;
    for (BodyId id : wall) moved += std::abs(cluster.state(id).position.x - 50) > 0.5;
    CHECK(moved > 5);
  }
}

TEST_CASE("a ball dropped on a heap over a corner strikes no stand-in, and the heap is cut again") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(1);
    into_four(world);
    std::vector<BodyId> heap;
    // A pyramid of boxes, its middle a little off the corner.
    for (int level = 0; level < 4; ++level)
      for (int i = 0; i < 4 - level; ++i)
        for (int k = 0; k < 4 - level; ++k)
          heap.push_back(put(
              world, box, {i - 0.5 * (3 - level) + 0.1, 0.5 + level, k - 0.5 * (3 - level) - 0.2},
              {0, 0, 0}, Activation::asleep));
    const BodyId dropped = put(world, ball, {0.1, 18, 0.15});
    RegionCluster cluster(world, delay);
    require_cut(cluster, world, 60);
    INFO("delay " << delay);
    step_to(cluster, world, 700, heap);
    CHECK(struck(cluster, world) == 0);
    REQUIRE(cluster.owner(dropped));
    for (BodyId id : heap) {
      REQUIRE(cluster.owner(id));
      const BodyState state = cluster.state(id);
      CHECK(state.activation == Activation::asleep);
      const int home = (state.position.x >= 0 ? 1 : 0) + (state.position.z >= 0 ? 2 : 0);
      const bool on_the_line = std::abs(state.position.x) < 0.5 || std::abs(state.position.z) < 0.5;
      CHECK((on_the_line || cluster.owner(id) == home));
    }
  }
}

TEST_CASE("a heap that rests on one server is cut without anybody noticing") {
  auto world = flat_world(2, 50);
  std::vector<BodyId> heap;
  for (int level = 0; level < 5; ++level)
    for (int i = 0; i < 6 - level; ++i)
      heap.push_back(
          put(world, box, {47.5 + i + 0.5 * level, 0.5 + level, 0}, {0, 0, 0}, Activation::asleep));
  for (auto& body : world.bodies) body.host = RegionId{0};
  RegionCluster cluster(world, 1);
  cluster.step(150);
  for (BodyId id : heap) {
    const BodyState state = cluster.state(id);
    CHECK(state.activation == Activation::asleep);
    CHECK(cluster.owner(id) == (state.position.x > 50.1 ? 1 : 0));
    CHECK(state.position == world.bodies[id.value & 0xffff].state.position);
  }
}

TEST_CASE("what stood on a neighbour's body falls when that is taken away") {
  auto world = flat_world(2, 50);
  const PrototypeId lid = plank;
  world.prototypes[2].body.shape = BoxShape{{1.5f, 0.1f, 0.3f}};
  // A lid whose middle is here, on one box here and one there.
  const BodyId here = put(world, box, {48.6, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId there = put(world, box, {51.1, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId on_top = put(world, lid, {49.9, 1.1, 0}, {0, 0, 0}, Activation::asleep);
  put(world, ball, {75, 0.8, 0}, {-18, 4.0f, 0});
  world.prototypes[0].body.mass_kg = 8;
  RegionCluster cluster(world, 1);
  cluster.step(30);
  REQUIRE(cluster.owner(there) == 1);
  REQUIRE(cluster.owner(on_top) == 0);
  const std::vector ids{here, there, on_top};
  step_to(cluster, world, 170, ids);
  REQUIRE(cluster.state(there).position.x < 50.5);
  CHECK(cluster.state(on_top).position.y < 1.05);
  CHECK(struck(cluster, world) == 0);
}

TEST_CASE("the watch over overlaps sees two bodies of different servers that are in each other") {
  auto world = flat_world(2, 50);
  world.mode = MigrationMode::naive;  // Bodies of two servers do not meet.
  const BodyId a = put(world, box, {48, 0.5, 0}, {4, 0, 0});
  const BodyId b = put(world, box, {52, 0.5, 0}, {-4, 0, 0});
  world.prototypes[1].body.friction = 0;
  RegionCluster cluster(world);
  OverlapWatch watch(world);
  for (int tick = 0; tick < 40; ++tick) {
    cluster.step();
    watch.look(cluster, world);
    if (!cluster.owner(a) || !cluster.owner(b)) continue;
    const double apart = std::abs(cluster.state(a).position.x - cluster.state(b).position.x);
    if (cluster.owner(a) != cluster.owner(b) && apart > 1.01) CHECK(watch.overlaps() == 0);
  }
  CHECK(watch.overlaps() > 0);
  CHECK(watch.deepest_m() > 0.1);
}
