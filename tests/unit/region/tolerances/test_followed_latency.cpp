// A latency tolerance that follows the links: up at once, down after a while, told to the policy.
#include "server/region/tolerances/followed_latency.h"

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

/// With frames of 15 ms: two steps up to 2 ms, three up to 18, four up to 34 …
struct Followed {
  FollowedLatency followed{AuraTolerances{}};
  Tick now{100};
  double in_force_ms = 2;
  void steps(std::int64_t count, double longest_ms) {
    for (std::int64_t n = 0; n < count; ++n) {
      now = now + 1;
      if (const auto changed = followed.step(now, longest_ms)) in_force_ms = changed->latency_ms;
    }
  }
};

}  // namespace

TEST_CASE("a followed latency tolerance rises in the step that measures more, in whole steps") {
  Followed f;
  f.steps(50, 0);
  CHECK(f.in_force_ms == 2);  // Nothing has been measured.
  f.steps(1, 1.5);
  CHECK(f.in_force_ms == 2);  // 1.9 with the room.
  f.steps(1, 1.7);
  CHECK(f.in_force_ms == 18);
  f.steps(1, 20);
  CHECK(f.in_force_ms == 34);
  f.steps(1, 10'000);
  CHECK(f.in_force_ms == Approx(FollowedLatency::latency_ms_max).margin(16));
}

TEST_CASE("it falls when less has been enough for five seconds, and to the most of that time") {
  Followed f;
  f.steps(1, 60);
  REQUIRE(f.in_force_ms == 82);
  f.steps(FollowedLatency::hold_ticks - 10, 1);
  CHECK(f.in_force_ms == 82);
  f.steps(1, 20);
  f.steps(9, 1);
  CHECK(f.in_force_ms == 82);
  f.steps(1, 1);
  CHECK(f.in_force_ms == 34);
  f.steps(FollowedLatency::hold_ticks + 1, 1);
  CHECK(f.in_force_ms == 2);
}

TEST_CASE("what is needed again in between keeps it up") {
  Followed f;
  f.steps(1, 60);
  for (int n = 0; n < 5; ++n) {
    f.steps(FollowedLatency::hold_ticks - 5, 1);
    f.steps(1, 60);
  }
  CHECK(f.in_force_ms == 82);
}

TEST_CASE("a region whose tolerance follows has left it once, and then keeps the longer one") {
  WorldDefinition world = flat_world(2);
  RegionCluster cluster(world);
  RegionCore &follows = cluster.core(0), &fixed = cluster.core(1);
  follows.follow_latency();
  cluster.step(20);
  follows.link_measured(RegionId{1}, 40);
  fixed.link_measured(RegionId{0}, 40);
  cluster.step();
  CHECK(follows.tolerance_events().size() == 1);
  CHECK(follows.tolerances_in_force().latency_ms == 50);
  CHECK(fixed.tolerances_in_force().latency_ms == 2);
  cluster.step(60);
  CHECK(follows.outside_tolerances().empty());
  CHECK_FALSE(fixed.outside_tolerances().empty());
}

TEST_CASE("auras are as large as the tolerance in force asks for, in both modes that have them") {
  for (const MigrationMode mode : {MigrationMode::paper, MigrationMode::adaptive}) {
    CAPTURE(name_of(mode));
    const auto policy = make_policy(mode, AuraTolerances{});
    const PartitionMap map({{-1000, -1000, 0, 1000}, {0, -1000, 1000, 1000}});
    HostedBody body;
    body.id = BodyId::world(1);
    body.position = {-0.1, 1, 0};
    body.half_extents = {0.3, 0.3, 0.3};
    body.bounding_radius_m = 0.3;
    body.velocity_mps = {-5, 0, 0};
    body.motion_speed_mps = 5;
    const std::vector<bool> linked{true, true};
    const auto reach_m = [&] {
      const MigrationDecision decision = policy->decide(
          {Tick{1000}, RegionId{0}, map, std::span(&body, 1), {}, {}, linked, nullptr});
      REQUIRE(decision.projected.size() == 1);
      return decision.projected.front().room.box().half.x();
    };
    const double before = reach_m();
    AuraTolerances longer;
    longer.latency_ms = 50;
    policy->set_tolerances(longer);
    const double after = reach_m();
    CHECK(after > before * 1.3);
    if (mode == MigrationMode::paper) CHECK(after == Approx(aura_radius_m(0.3, longer)));
    policy->set_tolerances(AuraTolerances{});
    CHECK(reach_m() == before);
  }
}
