// The same run once more, with the oracles looking at every tick instead of a clock.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/measure/measured/region_servers.h"
#include "server/measure/run_record.h"
#include "server/measure/wire_census.h"

namespace aureole {

/// How far handoffs moved bodies; see HandoffShadow.
struct HandoffJumps {
  std::size_t samples = 0;
  double p99_mm = 0, max_mm = 0;
  static HandoffJumps of(std::vector<double> jumps_mm);
};

struct Judgement {
  std::vector<std::uint64_t> missed, missed_in_tolerance;  ///< By bucket; see InteractionOracle.
  std::vector<HandoffJumps> jumps;                         ///< By bucket.
  HandoffJumps all_jumps;
  std::vector<WireCounts> wire;  ///< By bucket.
  WireCounts all_wire;
  std::uint64_t bodies_lost = 0, bodies_duplicated = 0;
  std::uint64_t state_hash = 0;         ///< At the end: that of the measured run.
  std::vector<std::string> violations;  ///< The first few of each rule, as sentences.
};

/// Oracles take longer than servers and would empty their caches, so the run that they look at is
/// not the one whose frames are measured. `options.clocks` and `options.judged` do not matter.
Judgement judge(const WorldDefinition& world, RegionServers::Options options,
                const BucketClock& clock, const std::function<void(Tick)>& progress);

}  // namespace aureole
