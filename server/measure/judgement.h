// The same run once more, with the oracles looking at every tick instead of a clock.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/measure/region_servers.h"
#include "server/measure/run_record.h"

namespace aureole {

struct Judgement {
  std::vector<std::uint64_t> missed, missed_in_tolerance;  ///< By bucket; see InteractionOracle.
  std::uint64_t bodies_lost = 0, bodies_duplicated = 0;
  std::uint64_t state_hash = 0;         ///< At the end: that of the measured run.
  std::vector<std::string> violations;  ///< The first few of each rule, as sentences.
};

/// Oracles take longer than servers and would empty their caches, so the run that they look at is
/// not the one whose frames are measured. `options.clock` and `options.judged` do not matter.
Judgement judge(const WorldDefinition& world, RegionServers::Options options,
                const BucketClock& clock, const std::function<void(Tick)>& progress);

}  // namespace aureole
