// Bodies poured onto a four-way corner: how much of the heap lies on a server that is not its own
// once it has come to rest.
#include <algorithm>
#include <string>

#include "server/experiment/simulation.h"
#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Share of the bodies that another server hosts than the one whose region they are in, once the
/// heap has come to rest. They pour for four seconds.
double foreign_hosted_share(MigrationMode mode, int bodies) {
  Scenario scenario;
  scenario.world = layout_world("corner4");
  scenario.world.mode = mode;
  scenario.kind = "pour";
  Injector& rain = scenario.world.injectors.emplace_back();
  rain.name = "rain";
  rain.start_s = 0.1;
  rain.duration_s = 4;
  rain.rate_per_s = bodies / rain.duration_s;
  rain.seed = 7;
  rain.mix = {{sphere_prototype, 1}, {cuboid_prototype, 1}, {capsule_prototype, 1}};
  rain.volume = {{-4, 4, -4}, {4, 9, 4}};
  rain.velocity_min = {-1, -5, -1};
  rain.velocity_max = {1, -2, 1};
  const PartitionMap map = partition_of(scenario.world);
  constexpr double longest_s = 100;
  SimulationOptions options;
  options.scenario = {"corner4", mode, 7, longest_s, bodies};
  Simulation simulation(std::move(scenario), options);
  const auto asleep = [&] {
    return std::all_of(simulation.seen().begin(), simulation.seen().end(),
                       [](const SeenBody& b) { return b.state.activation == Activation::asleep; });
  };
  // Lines that have moved come back once a world is calm, and then everything goes home.
  const auto lines_are_back = [&] {
    for (std::uint16_t r = 0; r < map.size(); ++r)
      if (!simulation.server(r).core().home_lines().settled()) return false;
    return true;
  };
  const auto all_there = static_cast<std::size_t>(bodies);
  std::int64_t calm_ticks = 0;
  for (std::int64_t tick = 0; tick < ticks_from_ms(1000 * longest_s) && calm_ticks < 128; ++tick) {
    simulation.tick();
    const bool calm = simulation.seen().size() == all_there && asleep() && lines_are_back();
    calm_ticks = calm ? calm_ticks + 1 : 0;
  }
  CHECK(calm_ticks == 128);
  CHECK(simulation.seen().size() == all_there);
  std::string broken;
  SeedResult judged;
  simulation.interactions().report(judged);
  for (const Violation& v : judged.violations)
    broken += "tick " + std::to_string(v.tick) + ": " + v.what + "\n";
  INFO(broken);
  CHECK(simulation.interactions().missed_in_tolerance() == 0);
  const auto foreign =
      std::count_if(simulation.seen().begin(), simulation.seen().end(), [&](const SeenBody& b) {
        return map.region_at(b.state.position.x, b.state.position.z) != b.owner;
      });
  return static_cast<double>(foreign) / bodies;
}

}  // namespace

TEST_CASE("of 2,000 bodies at rest on a corner adaptive hosts a quarter of paper's share abroad") {
  const double adaptive = foreign_hosted_share(MigrationMode::adaptive, 2000);
  const double paper = foreign_hosted_share(MigrationMode::paper, 2000);
  INFO("adaptive " << adaptive << ", paper " << paper);
  CHECK(paper > 0.2);
  CHECK(adaptive <= 0.25 * paper);
}
