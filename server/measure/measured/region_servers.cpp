// The fault simulation without faults, at an even pace.
#include "server/measure/measured/region_servers.h"

#include <algorithm>

#include "server/base/hash.h"

namespace aureole {

RegionServers::RegionServers(WorldDefinition world, const Options& options)
    : count_(static_cast<int>(world.regions.size())), frames_(world.regions.size()) {
  SimulationOptions o;
  o.scenario.seed = options.seed;
  o.network = options.network;
  o.pace = {
      true, false, options.clocks, options.follow_latency, options.own_heaps, options.before_frame};
  o.judged = options.judged;
  simulation_ = std::make_unique<Simulation>(Scenario{std::move(world), "measured", 0}, o);
}

void RegionServers::tick() {
  simulation_->tick();
  for (int r = 0; r < count_; ++r)
    if (const StepProfile* profile = simulation_->server(r).profile())
      frames_[static_cast<std::size_t>(r)] = frame_time(*profile);
}

std::vector<ServerLoad> RegionServers::loads() const {
  std::vector<ServerLoad> loads(frames_.size());
  for (int r = 0; r < count_; ++r) {
    const PhysicsWorld& physics = servers().server(r).core().physics();
    const PartitionMap& homes = servers().server(r).core().home_lines().map();
    ServerLoad& load = loads[static_cast<std::size_t>(r)];
    load.bodies = physics.size();
    load.awake = physics.awake_count();
    for (BodyId id : physics.ids()) {
      const WorldPosition at = physics.position(id);
      if (homes.region_at(at.x, at.z).value != r) ++load.foreign;
    }
  }
  return loads;
}

std::optional<MeasuredRun::Outside> RegionServers::outside_tolerances() const {
  Outside outside{};
  for (int r = 0; r < count_; ++r)
    for (const ToleranceEvent& event : servers().server(r).core().outside_tolerances())
      outside[static_cast<std::size_t>(event.kind)] = true;
  return outside;
}

std::optional<double> RegionServers::latency_tolerance_ms() const {
  double longest_ms = 0;
  for (int r = 0; r < count_; ++r)
    longest_ms = std::max(longest_ms, servers().server(r).core().tolerances_in_force().latency_ms);
  return longest_ms;
}

std::uint64_t RegionServers::migrations() const {
  std::uint64_t sum = 0;
  for (int r = 0; r < count_; ++r)
    sum += servers().server(r).core().hosting().counts().migrations_in;
  return sum;
}

std::vector<LinkTraffic> RegionServers::traffic() const {
  std::vector<LinkTraffic> links;
  for (int from = 0; from <= count_; ++from) {
    for (int to = 0; to <= count_; ++to) {
      if (from == to) continue;
      const auto& sent = servers().network().traffic(from, to);
      if (sent.messages > 0) links.push_back({from, to, sent.messages, sent.bytes});
    }
  }
  return links;
}

std::uint64_t RegionServers::state_hash() const {
  Hasher hash;
  for (int r = 0; r < count_; ++r) hash.add(servers().server(r).core().state_hash());
  return hash.value();
}

std::uint64_t RegionServers::refused_messages() const {
  std::uint64_t sum = servers().gateway().refusals().size();
  for (int r = 0; r < count_; ++r) sum += servers().server(r).refusals().size();
  return sum;
}

}  // namespace aureole
