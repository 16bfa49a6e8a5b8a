// How often a server tells another one that it has stepped, when it has nothing else to tell it.
#pragma once

#include <cstdint>

#include "server/aura/partition/partition_map.h"
#include "server/base/tick.h"

namespace aureole {

/// Regions are far from each other if nothing gets from one to the other within so long, at the
/// speed tolerance (s). Somebody in between hears first of what happens there; and as long as one
/// of two servers tells the other of auras, since bodies are hosted far from home, a word goes with
/// every step all the same.
inline constexpr double far_apart_s = 2.0;
/// Between two words to a region that is far away (ticks). With 64 regions, words in every step
/// were about a twentieth of a step.
inline constexpr std::int64_t far_word_interval_ticks = 8;

/// In every how many ticks at least two servers hear from each other. Both ends find the same.
inline std::int64_t word_interval_ticks(const PartitionMap& map, RegionId one, RegionId other,
                                        double speed_tolerance_mps) {
  const double apart_m = map.area(one).distance(map.area(other));
  return apart_m > speed_tolerance_mps * far_apart_s ? far_word_interval_ticks : 1;
}

/// Whether a word is due in the step `now` whose predecessor was `last`; who is held up makes up
/// for one that was left out.
inline bool is_word_due(Tick last, Tick now, std::int64_t interval_ticks) {
  return now.value / interval_ticks != last.value / interval_ticks;
}

}  // namespace aureole
