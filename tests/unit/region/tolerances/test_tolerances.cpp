// Tolerances: left at the exact tick, held again after a while, and never said twice.
#include <string>

#include "server/region/tolerances/tolerances.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = ToleranceEvent::Kind;

namespace {

/// Server 0 of three that hears both others in every step, until a test says otherwise.
struct Watch {
  Tolerances tolerances{AuraTolerances{}, RegionId{0}, 3};
  Tick now{1000};
  double frame_ms = 5;
  FastestBody fastest{BodyId::world(7), 3};
  bool hears_1 = true;
  std::vector<ToleranceEvent> events;

  Watch() {
    for (int i : {1, 2}) tolerances.link_up(RegionId{static_cast<std::uint16_t>(i)});
  }
  /// `missed`: ticks that are left out before it.
  void step(std::int64_t missed = 0) {
    now = now + 1 + missed;
    if (hears_1) tolerances.heard(RegionId{1}, now - 1);
    tolerances.heard(RegionId{2}, now - 1);
    tolerances.step(now, frame_ms, fastest);
    events.insert(events.end(), tolerances.events().begin(), tolerances.events().end());
  }
  void steps(std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) step();
  }
  bool is_outside(Kind kind) const {
    for (const ToleranceEvent& e : tolerances.outside())
      if (e.kind == kind) return true;
    return false;
  }
};

}  // namespace

TEST_CASE("nothing is said while everything stays inside its tolerance") {
  Watch watch;
  watch.fastest.speed_mps = 32;
  watch.frame_ms = 15;
  for (int i = 0; i < 300; ++i) {
    watch.tolerances.link_measured(RegionId{1}, 2);
    watch.step();
  }
  REQUIRE(watch.events.empty());
  REQUIRE(watch.tolerances.outside().empty());
}

TEST_CASE("a body at 40 m/s is flagged at once, by name") {
  Watch watch;
  watch.steps(10);
  watch.fastest = {BodyId::world(3), 40};
  watch.step();
  REQUIRE(watch.events.size() == 1);
  const ToleranceEvent& event = watch.events[0];
  REQUIRE(event.kind == Kind::speed);
  REQUIRE(event.outside);
  REQUIRE(event.tick == watch.now);
  REQUIRE(event.body == BodyId::world(3));
  REQUIRE(event.value == 40);
  REQUIRE(event.limit == 32);
}

TEST_CASE("a tolerance holds again once it has been kept for the time that auras need") {
  Watch watch;
  REQUIRE(watch.tolerances.settle_ticks() == 16);
  watch.fastest.speed_mps = 40;
  watch.steps(3);
  const Tick last_excess = watch.now;
  watch.fastest.speed_mps = 31;
  watch.steps(15);
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.is_outside(Kind::speed));
  watch.step();
  REQUIRE(watch.events.size() == 2);
  REQUIRE_FALSE(watch.events[1].outside);
  REQUIRE(watch.events[1].tick == last_excess + 16);
  REQUIRE(watch.events[1].value == 31);
  REQUIRE_FALSE(watch.is_outside(Kind::speed));
}

TEST_CASE("what flickers around its limit is said once") {
  Watch watch;
  for (int i = 0; i < 200; ++i) {
    watch.fastest.speed_mps = i % 10 == 0 ? 33 : 31;
    watch.step();
  }
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.tolerances.left_count() == 1);
}

TEST_CASE("slow networks hold their auras back for longer: so long do tolerances take to hold") {
  const Tolerances slow({32, 200, 15}, RegionId{0}, 2);
  REQUIRE(slow.settle_ticks() == 3 * 15 - 1);  // T_T
}

TEST_CASE("one long step is a frame time outside its tolerance") {
  Watch watch;
  watch.frame_ms = 15.1;
  watch.step();
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::frame_time);
  REQUIRE(watch.events[0].value == 15.1);
}

TEST_CASE("ticks that were left out count as frame time, whatever was measured") {
  Watch watch;
  watch.step();
  watch.step(4);
  REQUIRE(watch.events[0].kind == Kind::frame_time);
  REQUIRE(watch.events[0].value == 80);
  REQUIRE(watch.events[0].tick == watch.now);
}

TEST_CASE("the latency of a link is the longest of the last two seconds") {
  Watch watch;
  watch.tolerances.link_measured(RegionId{2}, 9);
  watch.tolerances.link_measured(RegionId{2}, 1);
  watch.step();
  const Tick exceeded = watch.now;
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::latency);
  REQUIRE(watch.events[0].peer == RegionId{2});
  REQUIRE(watch.events[0].value == 9);
  REQUIRE(watch.events[0].limit == 2);
  for (int i = 0; i < 300 && watch.events.size() < 2; ++i) {
    watch.tolerances.link_measured(RegionId{2}, 1);
    watch.step();
  }
  REQUIRE(watch.events.size() == 2);
  REQUIRE(watch.events[1].value == 1);
  REQUIRE(watch.now - exceeded ==
          Tolerances::latency_window_ticks - 1 + watch.tolerances.settle_ticks());
}

TEST_CASE("a link that is no longer measured keeps its last estimate") {
  Watch watch;
  watch.tolerances.link_measured(RegionId{1}, 50);
  watch.steps(1000);
  REQUIRE(watch.is_outside(Kind::latency));
}

TEST_CASE("what was measured of a link that ended does not count for the next one") {
  Watch watch;
  watch.tolerances.link_measured(RegionId{1}, 9);
  watch.step();
  REQUIRE(watch.tolerances.longest_latency_ms() == 9);
  watch.tolerances.link_down(RegionId{1});
  watch.tolerances.link_up(RegionId{1});
  REQUIRE(watch.tolerances.longest_latency_ms() == 0);
  watch.steps(watch.tolerances.settle_ticks());
  REQUIRE_FALSE(watch.is_outside(Kind::latency));
}

TEST_CASE("a silent peer is noticed as soon as its newest word is older than messages may be") {
  Watch watch;
  watch.steps(10);
  watch.hears_1 = false;  // The newest is of the step before the last one.
  watch.step();
  REQUIRE(watch.events.empty());
  watch.step();
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::link);
  REQUIRE(watch.events[0].peer == RegionId{1});
  REQUIRE(watch.events[0].value == 3);
  REQUIRE(watch.events[0].limit == 2);
  watch.steps(97);
  REQUIRE(watch.tolerances.outside()[0].value == 100);  // The worst so far.
  watch.hears_1 = true;
  watch.steps(16);
  REQUIRE(watch.events.size() == 2);
  REQUIRE(watch.events[1].value == 1);
}

TEST_CASE("words that come in a bunch, each of them too late, are as bad as silence") {
  Watch watch;
  watch.hears_1 = false;
  for (int i = 0; i < 50; ++i) {
    watch.tolerances.heard(RegionId{1}, watch.now - 2);
    watch.step();
  }
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::link);
  REQUIRE(watch.is_outside(Kind::link));
}

TEST_CASE("a peer that claims to be ahead of time is not believed for longer than a step") {
  Watch watch;
  watch.tolerances.heard(RegionId{1}, Tick{1'000'000'000});
  watch.hears_1 = false;
  watch.steps(4);
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::link);
}

TEST_CASE("a link that ends is outside until it has been up again for a while") {
  Watch watch;
  watch.steps(5);
  watch.tolerances.link_down(RegionId{1});
  watch.hears_1 = false;
  watch.step();
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::link);
  watch.steps(50);
  watch.tolerances.link_up(RegionId{1});
  watch.hears_1 = true;
  watch.steps(15);
  REQUIRE(watch.events.size() == 1);
  watch.steps(2);
  REQUIRE(watch.events.size() == 2);
}

TEST_CASE("a link that breaks and comes back between two steps does not go unnoticed") {
  Watch watch;
  watch.steps(5);
  watch.tolerances.link_down(RegionId{1});
  watch.tolerances.link_up(RegionId{1});
  watch.step();
  REQUIRE(watch.events.size() == 1);
  REQUIRE(watch.events[0].kind == Kind::link);
}

TEST_CASE("of each tolerance the worst is shown, with the tick at which it was left") {
  Watch watch;
  watch.tolerances.link_measured(RegionId{1}, 5);
  watch.frame_ms = 20;
  watch.step();
  const Tick left = watch.now;
  watch.tolerances.link_measured(RegionId{2}, 30);
  watch.frame_ms = 25;
  watch.step();
  const auto outside = watch.tolerances.outside();
  REQUIRE(outside.size() == 2);
  REQUIRE(outside[0].kind == Kind::latency);
  REQUIRE(outside[0].peer == RegionId{2});
  REQUIRE(outside[1].kind == Kind::frame_time);
  REQUIRE(outside[1].tick == left);
  REQUIRE(outside[1].value == 25);
  REQUIRE(watch.tolerances.left_count() == 3);
}

TEST_CASE("two regions at rest hear each other in every step and stay inside every tolerance") {
  WorldDefinition world = flat_world(2);
  put(world, box, {10, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world, 1);
  for (int i = 0; i < 200; ++i) {
    cluster.step();
    REQUIRE(cluster.core(0).tolerance_events().empty());
    REQUIRE(cluster.core(1).tolerance_events().empty());
  }
  cluster.cut_link(0, 1);
  cluster.step();
  REQUIRE(cluster.core(0).tolerance_events().size() == 1);
  REQUIRE(cluster.core(0).tolerance_events()[0].peer == RegionId{1});
  REQUIRE(cluster.core(0).statistics().tolerance_events == 1);
}

TEST_CASE("a region whose links take longer than they may says so from the first late word on") {
  const WorldDefinition world = flat_world(2);
  RegionCluster cluster(world, 2);
  std::size_t said = 0;
  for (int i = 0; i < 20; ++i) {
    cluster.step();
    said += cluster.core(0).tolerance_events().size();
  }
  REQUIRE(said == 1);
}

TEST_CASE(
    "a region names its body that is faster than 32 m/s, in the step in which it becomes so") {
  WorldDefinition world = flat_world(2);
  const BodyId fast = put(world, ball, {20, 5, 0}, {40, 0, 0});
  const BodyId slow = put(world, ball, {10, 5, 0}, {31, 0, 0});
  RegionCluster cluster(world);
  cluster.step();
  const auto events = cluster.core(0).tolerance_events();
  REQUIRE(events.size() == 1);
  REQUIRE(events[0].kind == Kind::speed);
  REQUIRE(events[0].body == fast);
  REQUIRE(events[0].body != slow);
  REQUIRE(events[0].tick == Tick{1});
  REQUIRE(cluster.core(1).tolerance_events().empty());
}

TEST_CASE("a peer that says a word in eight steps is outside when it is late, and no sooner") {
  Tolerances tolerances{AuraTolerances{}, RegionId{0}, 2};
  tolerances.link_up(RegionId{1});
  tolerances.expect_word(RegionId{1}, 8);
  const FastestBody fastest{BodyId::world(7), 3};
  Tick now{1000};
  for (int i = 0; i < 66; ++i) {
    now = now + 1;
    // Two ticks on the way, as long as equation (1) gives them.
    if (now.value % 8 == 2) tolerances.heard(RegionId{1}, now - 2);
    tolerances.step(now, 5, fastest);
    REQUIRE(tolerances.events().empty());
  }
  // The newest word is of tick 1064: that of 1072 is missed at 1074.
  while (now < Tick{1073}) {
    now = now + 1;
    tolerances.step(now, 5, fastest);
    REQUIRE(tolerances.events().empty());
  }
  tolerances.step(Tick{1074}, 5, fastest);
  REQUIRE(tolerances.events().size() == 1);
  CHECK(tolerances.events()[0].kind == Kind::link);
  CHECK(tolerances.events()[0].limit == 9);
  CHECK(tolerances.events()[0].value == 10);
}
