// Ticks until the last one has been looked at.
#include "server/measure/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace aureole {

HandoffJumps HandoffJumps::of(std::vector<double> jumps_mm) {
  HandoffJumps jumps;
  jumps.samples = jumps_mm.size();
  if (jumps_mm.empty()) return jumps;
  std::sort(jumps_mm.begin(), jumps_mm.end());
  // The smallest that 99 % do not pass.
  const auto rank =
      static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(jumps_mm.size())));
  jumps.p99_mm = jumps_mm[rank - 1];
  jumps.max_mm = jumps_mm.back();
  return jumps;
}

Judgement judge(const WorldDefinition& world, RegionServers::Options options,
                const BucketClock& clock, const std::function<void(Tick)>& progress) {
  options.clocks = {};
  options.judged = true;
  RegionServers servers(world, options);
  const InteractionOracle& interactions = servers.simulation().interactions();
  HandoffShadow& shadow = servers.simulation().shadow();
  WireCensus census(static_cast<int>(world.regions.size()));
  servers.simulation().network().watch(
      [&](End from, End to, const SharedBytes& frame) { census.note(from, to, *frame); });

  Judgement judged;
  judged.missed.assign(clock.count(), 0);
  judged.missed_in_tolerance = judged.missed;
  std::uint64_t missed = 0, in_tolerance = 0;
  std::size_t jumps_before = 0;
  // Oracles look at a tick when everyone has taken it for certain.
  for (Tick now{1}; now <= clock.last() + WorldView::delay_ticks; now = now + 1) {
    servers.tick();
    progress(now);
    if (now == clock.last()) judged.state_hash = servers.state_hash();
    if (now <= clock.last() && clock.ends_with(now)) {
      judged.wire.push_back(census.counts() - judged.all_wire);
      judged.all_wire = census.counts();
      const auto& jumps = shadow.jumps_mm();
      judged.jumps.push_back(HandoffJumps::of(
          {jumps.begin() + static_cast<std::ptrdiff_t>(jumps_before), jumps.end()}));
      jumps_before = jumps.size();
      shadow.sample_anew();
    }
    const Tick seen = now - WorldView::delay_ticks;
    const std::size_t bucket = clock.of(std::max(seen, Tick{1}));
    judged.missed[bucket] += interactions.missed() - missed;
    judged.missed_in_tolerance[bucket] += interactions.missed_in_tolerance() - in_tolerance;
    missed = interactions.missed();
    in_tolerance = interactions.missed_in_tolerance();
  }
  judged.all_jumps = HandoffJumps::of(shadow.jumps_mm());
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
