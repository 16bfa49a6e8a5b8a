// Handoffs under faults at every moment, supports that are handed away, and towers that are cut.
#include <set>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/scenarios/overlap_watch.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr auto asleep = Activation::asleep;

bool journals_empty(RegionCluster& cluster) {
  return cluster.core(0).journal(RegionId{1}).unacknowledged().empty() &&
         cluster.core(1).journal(RegionId{0}).unacknowledged().empty();
}

}  // namespace

TEST_CASE("a handoff survives a reset of the link at any moment: sent, accepted, acknowledged") {
  for (const int delay : {0, 1, 3})
    for (int after = 0; after < 3 * (delay + 1) + 3; ++after) {
      auto world = flat_world(2);
      const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
      RegionCluster cluster(world, delay);
      cluster.step();
      while (cluster.owner(id) == 0) cluster.step();
      cluster.step(after);
      cluster.reset_link(0, 1);
      INFO("delay " << delay << ", reset " << after << " ticks after it was sent");
      for (int tick = 0; tick < 40; ++tick) {
        cluster.step();
        REQUIRE(cluster.bodies_in_world() == 1);
      }
      REQUIRE(cluster.owner(id) == 1);
      REQUIRE(cluster.core(1).statistics().migrations_in == 1);
      REQUIRE(cluster.core(1).statistics().version_conflicts == 0);
      REQUIRE(journals_empty(cluster));
      REQUIRE(cluster.faults().empty());
    }
}

TEST_CASE("a handoff survives two resets in a row at any two moments") {
  const int delay = 2;
  for (int first = 0; first < 7; ++first)
    for (int second = 1; second < 7; ++second) {
      auto world = flat_world(2);
      const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
      RegionCluster cluster(world, delay);
      cluster.step();
      while (cluster.owner(id) == 0) cluster.step();
      cluster.step(first);
      cluster.reset_link(0, 1);
      cluster.step(second);
      cluster.reset_link(0, 1);
      cluster.step(40);
      INFO("resets " << first << " and " << first + second << " ticks after it was sent");
      REQUIRE(cluster.owner(id) == 1);
      REQUIRE(cluster.bodies_in_world() == 1);
      REQUIRE(cluster.core(1).statistics().migrations_in == 1);
      REQUIRE(journals_empty(cluster));
    }
}

TEST_CASE("a link that has come up, and brings nothing yet, holds nothing back between others") {
  for (int at = 10; at < 34; ++at) {
    auto world = flat_world(3);
    const BodyId a = put(world, ball, {42, 0.3, 0}, {15, 0, 0});
    const BodyId b = put(world, ball, {58, 0.3, 0}, {-15, 0, 0});
    RegionCluster cluster(world, 1);
    OverlapWatch watch(world);
    for (int tick = 0; tick < 64; ++tick) {
      if (tick == at) {
        cluster.reset_link(1, 2);
        cluster.silence(2, 1);
      }
      cluster.step();
      watch.look(cluster, world);
    }
    INFO("up again at tick " << at << "; " << watch.worst());
    REQUIRE(watch.overlaps() == 0);
    REQUIRE(cluster.owner(a) == cluster.owner(b));
    REQUIRE(cluster.state(a).linear_velocity.x() < cluster.state(b).linear_velocity.x());
    REQUIRE(cluster.state(a).position.x < cluster.state(b).position.x);
  }
}

TEST_CASE("a sleeping support that is handed away wakes what stood on it, and that falls") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(2);
    // Naive servers cut the two by their centres; nothing stands in for the support.
    world.mode = MigrationMode::naive;
    const BodyId support = put(world, box, {50.2, 0.5, 0}, {0, 0, 0}, asleep);
    const BodyId on_top = put(world, box, {49.95, 1.5, 0}, {0, 0, 0}, asleep);
    for (auto& body : world.bodies) body.host = RegionId{0};
    RegionCluster cluster(world, delay);
    cluster.step(80);
    REQUIRE(cluster.owner(support) == 1);
    REQUIRE(cluster.owner(on_top) == 0);
    REQUIRE(cluster.state(on_top).position.y < 0.6);
  }
}

TEST_CASE("what stands on a support that is handed away stays up where a stand-in is left") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(2);
    const BodyId support = put(world, box, {50.2, 0.5, 0}, {0, 0, 0}, asleep);
    const BodyId on_top = put(world, box, {49.95, 1.5, 0}, {0, 0, 0}, asleep);
    for (auto& body : world.bodies) body.host = RegionId{0};
    RegionCluster cluster(world, delay);
    cluster.step(200);
    REQUIRE(cluster.owner(support) == 1);
    REQUIRE(cluster.owner(on_top) == 0);
    CHECK(cluster.state(on_top).activation == asleep);
    CHECK(distance(cluster.state(on_top).position, {49.95, 1.5, 0}) < 1e-3);
    CHECK(cluster.core(0).statistics().struck_stand_ins == 0);
  }
}

TEST_CASE("a tower that leans hard on its foot is handed over awake and moves under a millimetre") {
  for (const int delay : {0, 1}) {
    auto world = flat_world(2);
    world.mode = MigrationMode::naive;
    std::vector<BodyId> tower;
    for (int i = 0; i < 10; ++i) {
      tower.push_back(put(world, box, {49.8, 0.5 + i, 0}));
      world.bodies.back().host = RegionId{1};
    }
    auto alone = world;
    alone.regions = flat_world(1).regions;
    for (auto& body : alone.bodies) body.host.reset();
    RegionCluster split(world, delay), one(alone);
    // Long enough for the contacts to carry the weight before they are cut out of their world.
    for (int tick = 0; tick < 60; ++tick) {
      split.step();
      one.step();
      for (BodyId id : tower) {
        if (!split.owner(id)) continue;
        INFO("delay " << delay << ", tick " << tick);
        REQUIRE(distance(split.state(id).position, one.state(id).position) < 1e-3);
      }
    }
    for (BodyId id : tower) REQUIRE(split.owner(id) == 0);
  }
}
