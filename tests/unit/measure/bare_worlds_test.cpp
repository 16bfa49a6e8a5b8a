// The limits that servers are measured against: worlds that hand bodies over, worlds that do not.
#include "server/measure/measured/bare_worlds.h"

#include "server/experiment/scenario/scenario.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr Tick until{190};

/// Two regions, and bodies that are thrown from the left one to the right one and back.
WorldDefinition crossing_world() {
  WorldDefinition world = layout_world("corner4");
  world.physics = {};
  world.regions = grid_of_regions(2, 1, 150);
  for (const double side : {-1.0, 1.0}) {
    Injector& made = world.injectors.emplace_back();
    made.rate_per_s = 20;
    made.volume = {{side * 3 - 1, 3, -10}, {side * 3 + 1, 5, 10}};
    made.velocity_min = made.velocity_max = {static_cast<float>(-side * 8), 0, 0};
    made.mix = {{sphere_prototype, 1}, {cuboid_prototype, 1}};
    made.seed = side > 0 ? 1 : 2;
  }
  return world;
}

std::uint64_t foreign(const MeasuredRun& run) {
  std::uint64_t sum = 0;
  for (const ServerLoad& load : run.loads()) sum += load.foreign;
  return sum;
}

std::uint64_t bodies(const MeasuredRun& run) {
  std::uint64_t sum = 0;
  for (const ServerLoad& load : run.loads()) sum += load.bodies;
  return sum;
}

std::int64_t clock_that_counts() {
  static std::int64_t readings = 0;
  return ++readings * 1'000'000;
}

}  // namespace

TEST_CASE("after every tick what crosses a boundary is in its own region's world in `cut`") {
  const WorldDefinition world = crossing_world();
  BareWorlds cut(world, BareWorlds::Crossing::handed_over, &clock_that_counts);
  for (Tick now{1}; now <= until; now = now + 1) {
    cut.tick();
    REQUIRE(foreign(cut) == 0);
  }
  CHECK(cut.migrations() > 50);
}

TEST_CASE("in `ideal` a body stays in the world that it came into, wherever it goes") {
  const WorldDefinition world = crossing_world();
  BareWorlds ideal(world, BareWorlds::Crossing::stays, &clock_that_counts);
  BareWorlds cut(world, BareWorlds::Crossing::handed_over, &clock_that_counts);
  for (Tick now{1}; now <= until; now = now + 1) {
    ideal.tick();
    cut.tick();
  }
  CHECK(foreign(ideal) > 20);
  CHECK(ideal.migrations() == 0);
  CHECK(bodies(ideal) == bodies(cut));
  CHECK(ideal.state_hash() != cut.state_hash());
}

TEST_CASE("a body that is handed over in `cut` goes on as if nothing had happened") {
  // One alone meets nobody: it must be where it is in a world that was never cut.
  WorldDefinition world = crossing_world();
  world.injectors.resize(1);
  world.injectors.front().duration_s = 0.05;
  WorldDefinition whole = world;
  whole.regions.resize(1);
  whole.regions.front().area = {};
  BareWorlds cut(world, BareWorlds::Crossing::handed_over, &clock_that_counts);
  BareWorlds one(whole, BareWorlds::Crossing::handed_over, &clock_that_counts);
  for (Tick now{1}; now <= until; now = now + 1) {
    cut.tick();
    one.tick();
  }
  REQUIRE(bodies(cut) == 1);
  CHECK(cut.migrations() == 1);
  CHECK(cut.loads()[1].bodies == 1);
  const auto body = one.world(0).ids().front();
  const double apart = distance(cut.world(1).position(body), one.world(0).position(body));
  CHECK(apart == 0);
}

TEST_CASE("only the time between a frame's clock readings counts") {
  const WorldDefinition world = crossing_world();
  BareWorlds cut(world, BareWorlds::Crossing::handed_over, {&clock_that_counts, &steady_ns});
  cut.tick();
  // The clock goes on by a millisecond with each reading, and is read at both ends.
  for (const FrameTime& frame : cut.frames()) CHECK(total_ms(frame) == Approx(1));
}
