// The fault simulation without faults and oracles, at an even pace.
#include "server/bench/running_servers.h"

#include "server/bench/situations.h"

namespace aureole {

RunningServers::RunningServers(const BenchOptions& options) {
  WorldDefinition world = two_servers(options);
  count_ = static_cast<int>(world.regions.size());
  SimulationOptions o;
  o.scenario.seed = options.seed;
  o.pace = {true, false, cpu_clocks()};
  o.judged = false;
  simulation_ = std::make_unique<Simulation>(Scenario{std::move(world), "bench", 0}, o);
}

void RunningServers::run(double seconds) {
  const auto ticks = static_cast<std::int64_t>(seconds * 1e6) / tick_us;
  for (std::int64_t n = 0; n < ticks; ++n) tick();
}

}  // namespace aureole
