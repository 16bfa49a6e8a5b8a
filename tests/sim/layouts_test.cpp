// A few short seeds of every layout hold every rule; many long ones are `aureole simulate`'s work.
#include "server/experiment/simulation.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

SeedResult run(const std::string& layout, MigrationMode mode, std::uint64_t seed,
               FaultKinds faults) {
  SimulationOptions options;
  options.scenario = {layout, mode, seed, 8, 80};
  options.faults = faults;
  auto result = simulate(options);
  if (!result) throw std::runtime_error(result.error().message);
  return *result;
}

/// What broke, for the failure message.
std::string told(const SeedResult& result) {
  std::string all = "seed " + std::to_string(result.seed) + " (" + result.scenario + ")";
  for (const Violation& v : result.violations)
    all += "\n" + v.rule + " at tick " + std::to_string(v.tick) + ": " + v.what;
  return all;
}

}  // namespace

TEST_CASE("without faults every layout holds every rule: pours, flights, rows, players") {
  for (const std::string layout : {"column4", "corner3", "corner4", "corner9"}) {
    for (std::uint64_t seed = 2; seed <= 5; ++seed) {
      const SeedResult result = run(layout, MigrationMode::adaptive, seed, FaultKinds::none);
      INFO(layout << ", " << told(result));
      CHECK(result.all_rules_held());
      CHECK(result.tolerance_events == 0);
    }
  }
}

TEST_CASE("under stalls, resets, slow servers and crashes every layout holds every rule") {
  for (const std::string layout : {"column4", "corner3", "corner4", "corner9"}) {
    for (std::uint64_t seed = 2; seed <= 3; ++seed) {
      const SeedResult result = run(layout, MigrationMode::adaptive, seed, FaultKinds::all);
      INFO(layout << ", " << told(result));
      CHECK(result.all_rules_held());
    }
  }
}

TEST_CASE("on the same seeds the naive mode misses interactions, so the oracle can see them") {
  for (const std::string layout : {"column4", "corner3", "corner4", "corner9"}) {
    const SeedResult result = run(layout, MigrationMode::naive, 2, FaultKinds::none);
    INFO(layout << ", " << told(result));
    CHECK(result.missed_interactions_in_tolerance > 0);
    CHECK(result.bodies_lost + result.bodies_duplicated == 0);
  }
}
