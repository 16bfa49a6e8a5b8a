// Runs a world to its end and keeps what the oracles see.
#include "server/experiment/oracles/view/film.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/experiment/simulation.h"

namespace aureole {

Film::Film(const WorldDefinition& world, NetworkTiming timing, int ticks) {
  SimulationOptions options;
  options.scenario.seed = 1;
  options.scenario.seconds = ticks * tick_s;
  options.network = timing;
  Simulation simulation(Scenario{world, "comparison", 0}, options);
  std::map<BodyId, RegionId> owners;
  for (int t = 0; t < ticks; ++t) {
    simulation.tick();
    auto& moment = moments_.emplace_back();
    for (const SeenBody& b : simulation.seen()) {
      moment.emplace(b.id, Shot{b.state, b.owner});
      const auto [known, fresh] = owners.try_emplace(b.id, b.owner);
      if (!fresh && known->second != b.owner) ++handoffs_[b.id];
      known->second = b.owner;
    }
    std::uint64_t stand_ins = 0;
    for (int r = 0; r < static_cast<int>(world.regions.size()); ++r)
      stand_ins += simulation.server(r).core().statistics().stand_ins;
    stand_ins_max_ = std::max(stand_ins_max_, stand_ins);
  }
}

const Film::Shot* Film::at(int moment, BodyId id) const {
  const auto& shots = moments_[static_cast<std::size_t>(moment)];
  const auto it = shots.find(id);
  return it == shots.end() ? nullptr : &it->second;
}

std::string Film::place(int moment, BodyId id) const {
  const Shot* shot = at(moment, id);
  return fmt::format("at tick {}, {} on {}", tick_of(moment).value, describe(id),
                     shot == nullptr ? "no server" : fmt::format("r{}", shot->owner.value));
}

std::uint64_t Film::handoffs(BodyId id) const {
  const auto it = handoffs_.find(id);
  return it == handoffs_.end() ? 0 : it->second;
}

std::uint64_t Film::handoffs() const {
  std::uint64_t all = 0;
  for (const auto& [id, count] : handoffs_) all += count;
  return all;
}

}  // namespace aureole
