// A step's parts, and that they are told apart without a gap.
#include "server/region/step_profile.h"

#include <numeric>

#include "server/measure/measured/region_servers.h"
#include "server/measure/workload/workload.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::int64_t now_ns = 0;
std::int64_t told_clock() {
  return now_ns;
}

std::int64_t cpu_ns = 0;
std::int64_t cpu_clock() {
  return cpu_ns;
}

std::int64_t readings = 0;
std::int64_t clock_that_counts() {
  return ++readings;
}

}  // namespace

TEST_CASE("time goes to the part that was entered last, and nowhere after a stop") {
  StepProfile profile(&told_clock);
  now_ns = 100;
  profile.enter(StepProfile::Part::wire);
  now_ns = 110;
  profile.enter(StepProfile::Part::physics);
  now_ns = 140;
  profile.enter(StepProfile::Part::wire);
  now_ns = 142;
  profile.stop();
  now_ns = 1000;
  profile.stop();
  CHECK(profile.spent_ns() == std::array<std::int64_t, 4>{30, 0, 0, 12});
  profile.enter(StepProfile::Part::aura);
  now_ns = 1007;
  profile.enter(StepProfile::Part::decide);
  now_ns = 1009;
  profile.stop();
  CHECK(profile.spent_ns() == std::array<std::int64_t, 4>{30, 7, 2, 12});
  profile.clear();
  CHECK(profile.spent_ns() == std::array<std::int64_t, 4>{});
}

TEST_CASE("parts share out the time of the whole, as the quicker clock tells them apart") {
  StepProfile profile({&cpu_clock, &told_clock});
  now_ns = 0;
  cpu_ns = 1000;
  profile.enter(StepProfile::Part::physics);
  now_ns = 30;
  profile.enter(StepProfile::Part::wire);
  now_ns = 40;
  cpu_ns = 1020;
  profile.stop();
  CHECK(profile.spent_ns() == std::array<std::int64_t, 4>{15, 0, 0, 5});
  // One that no time passes in has nothing to share out.
  profile.enter(StepProfile::Part::aura);
  cpu_ns = 1021;
  profile.stop();
  CHECK(profile.spent_ns() == std::array<std::int64_t, 4>{15, 0, 0, 5});
}

TEST_CASE("servers read the clock a few times a step, and not at all when nobody asks") {
  WorkloadOptions workload;
  workload.seconds = 1;
  const auto world = workload_world(workload);
  REQUIRE(world);
  RegionServers::Options options;
  RegionServers unasked(*world, options);
  options.clocks = &clock_that_counts;
  readings = 0;
  RegionServers asked(*world, options);
  for (int tick = 1; tick <= 60; ++tick) {
    unasked.tick();
    const std::int64_t before = readings;
    asked.tick();
    const std::int64_t in_tick = readings - before;
    REQUIRE(in_tick > 0);
    REQUIRE(in_tick <= 2 * 20);
  }
  CHECK(unasked.state_hash() == asked.state_hash());
  for (const FrameTime& frame : unasked.frames()) CHECK(total_ms(frame) == 0);
  for (const FrameTime& frame : asked.frames())
    for (const double part_ms : frame) CHECK(part_ms > 0);
}
