// Bodies poured onto a four-way corner: how much of the heap lies on a server that is not its own
// once it has come to rest.
#include "server/experiment/simulation.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Share of the bodies that another server hosts than the one whose region they are in: mean over
/// the last tenth of the run. They pour for the first third of it.
double foreign_hosted_share(MigrationMode mode, int bodies, double seconds) {
  Scenario scenario;
  scenario.world = layout_world("corner4");
  scenario.world.mode = mode;
  scenario.kind = "pour";
  Injector& rain = scenario.world.injectors.emplace_back();
  rain.name = "rain";
  rain.start_s = 0.1;
  rain.duration_s = seconds / 3;
  rain.rate_per_s = bodies / rain.duration_s;
  rain.seed = 7;
  rain.mix = {{sphere_prototype, 1}, {cuboid_prototype, 1}, {capsule_prototype, 1}};
  rain.volume = {{-4, 4, -4}, {4, 9, 4}};
  rain.velocity_min = {-1, -5, -1};
  rain.velocity_max = {1, -2, 1};
  const PartitionMap map = partition_of(scenario.world);
  SimulationOptions options;
  options.scenario = {"corner4", mode, 7, seconds, bodies};
  Simulation simulation(std::move(scenario), options);
  double foreign = 0, all = 0;
  for (std::int64_t tick = 0; tick < ticks_from_ms(1000 * seconds); ++tick) {
    simulation.tick();
    if (10 * tick < 9 * ticks_from_ms(1000 * seconds)) continue;
    for (const SeenBody& b : simulation.seen())
      foreign += map.region_at(b.state.position.x, b.state.position.z) != b.owner;
    all += static_cast<double>(simulation.seen().size());
  }
  return foreign / all;
}

}  // namespace

TEST_CASE(
    "of a heap at rest on a four-way corner adaptive hosts a quarter of paper's share abroad") {
  const double adaptive = foreign_hosted_share(MigrationMode::adaptive, 2000, 30);
  const double paper = foreign_hosted_share(MigrationMode::paper, 2000, 30);
  INFO("adaptive " << adaptive << ", paper " << paper);
  CHECK(paper > 0.2);
  CHECK(adaptive <= 0.25 * paper);
}
