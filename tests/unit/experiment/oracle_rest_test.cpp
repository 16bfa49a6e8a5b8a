// What rests, where, and what the rest oracle says of it.
#include "server/experiment/simulation.h"
#include "tests/support/catch.h"
#include "tests/unit/experiment/oracle_runs.h"

using namespace aureole;

TEST_CASE("a body that sleeps in another server's region is not settled") {
  WorldDefinition world = layout_world("column4");
  put_body(world, sphere_prototype, {-5, 0.3, 0}, {0, 0, 0}, Activation::asleep);
  world.bodies[0].host = RegionId{2};
  SimulationOptions options = calm(1);
  Simulation simulation({world, "test", 0}, options);
  // While the two are not linked it cannot go home.
  simulation.network().reset(1, 2, 0, 3'600'000'000);
  for (int t = 0; t < 100; ++t) simulation.tick();
  const SeedResult result = simulation.finish();
  REQUIRE(result.unsettled == 1);
  REQUIRE(told_of(result, "unsettled"));
}

TEST_CASE("what sleeps abroad is not settled though others move, only what they may touch waits") {
  struct Case {
    double mover_x;
    std::uint64_t unsettled, waits;
  };
  // r1 is from -32 to 0; a ball of r2's sleeps in it, another one rolls near to it or far away.
  for (const Case& c : {Case{20, 1, 0}, Case{-6, 0, 1}}) {
    WorldDefinition world = layout_world("column4");
    put_body(world, sphere_prototype, {-5, 0.3, 0}, {0, 0, 0}, Activation::asleep);
    put_body(world, sphere_prototype, {c.mover_x, 2, 0}, {0, 0, 0});
    for (WorldBody& body : world.bodies) body.host = RegionId{2};
    world.bodies[1].state.angular_velocity = {0, 5, 0};
    Simulation simulation({world, "test", 0}, calm(1));
    simulation.network().reset(1, 2, 0, 3'600'000'000);
    for (int t = 0; t < 20; ++t) simulation.tick();
    const SeedResult result = simulation.finish();
    INFO("the other one at " << c.mover_x);
    REQUIRE(result.awake_at_end == 1);
    REQUIRE(result.unsettled == c.unsettled);
    REQUIRE(result.rest_not_judged == c.waits);
  }
}

TEST_CASE("what sleeps where a line has just passed is not judged while others move") {
  WorldDefinition world = layout_world("column4");
  // A crowd in the air beside the line at x = 0, and sleepers on the side that it will move to.
  for (int i = 0; i < 12; ++i) put_body(world, sphere_prototype, {-6, 60, 2.0 * i}, {0, 20, 0});
  constexpr int sleepers = 8;
  for (int i = 0; i < sleepers; ++i)
    put_body(world, sphere_prototype, {0.5 + i, 0.3, -20}, {0, 0, 0}, Activation::asleep);
  SimulationOptions options = calm(6);
  options.pace.level_from = 4;
  Simulation simulation({world, "test", 0}, options);
  const auto lines = [&] { return simulation.server(1).core().home_lines().map().version(); };
  const std::uint64_t at_first = lines();
  for (int t = 0; t < 330 && lines() == at_first; ++t) simulation.tick();
  REQUIRE(lines() != at_first);
  for (int t = 0; t < 4; ++t) simulation.tick();
  // One that the line has passed has gone home: while all lie still that would be a mistake.
  REQUIRE(simulation.server(2).core().physics().size() == sleepers - 1);
  const SeedResult result = simulation.finish();
  CHECK(result.awake_at_end == 12);
  CHECK(result.unsettled == 0);
  CHECK(result.rest_not_judged == sleepers);
}
