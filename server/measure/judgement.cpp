// Ticks until the last one has been looked at.
#include "server/measure/judgement.h"

#include <fmt/format.h>

namespace aureole {

Judgement judge(const WorldDefinition& world, RegionServers::Options options,
                const BucketClock& clock, const std::function<void(Tick)>& progress) {
  options.clock = nullptr;
  options.judged = true;
  RegionServers servers(world, options);
  const InteractionOracle& interactions = servers.simulation().interactions();

  Judgement judged;
  judged.missed.assign(clock.count(), 0);
  judged.missed_in_tolerance = judged.missed;
  std::uint64_t missed = 0, in_tolerance = 0;
  // Oracles look at a tick when everyone has taken it for certain.
  for (Tick now{1}; now <= clock.last() + WorldView::delay_ticks; now = now + 1) {
    servers.tick();
    progress(now);
    if (now == clock.last()) judged.state_hash = servers.state_hash();
    const Tick seen = now - WorldView::delay_ticks;
    const std::size_t bucket = clock.of(std::max(seen, Tick{1}));
    judged.missed[bucket] += interactions.missed() - missed;
    judged.missed_in_tolerance[bucket] += interactions.missed_in_tolerance() - in_tolerance;
    missed = interactions.missed();
    in_tolerance = interactions.missed_in_tolerance();
  }
  SeedResult result;
  servers.simulation().ownership().report(result);
  interactions.report(result);
  judged.bodies_lost = result.bodies_lost;
  judged.bodies_duplicated = result.bodies_duplicated;
  for (const Violation& v : result.violations)
    judged.violations.push_back(fmt::format("{} at tick {}: {}", v.rule, v.tick, v.what));
  return judged;
}

}  // namespace aureole
