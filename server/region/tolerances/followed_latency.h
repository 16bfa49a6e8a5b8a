// A latency tolerance that follows what the links measure, instead of one that somebody set.
#pragma once

#include <optional>

#include "server/aura/shapes/aura_radius.h"
#include "server/base/tick.h"

namespace aureole {

/// Follows the longest latency that any link of a server has measured lately (Tolerances keeps the
/// longest of 2 s), with room for what pings do not see. It rises at once: the step that measures
/// more has left its tolerance and says so, the next one keeps the new one. It falls when less was
/// enough for hold_ticks. Only whole steps make auras larger, so that it is always the longest
/// latency for which equation (1) gives the same number of steps.
///
/// Two servers may follow to different values. Each one's covers every link of its own, so that
/// both ends of a link cover it, and an aura that is larger than it need be is no danger. Bodies
/// that a server asks another one to hand to a third travel on a link that the first does not
/// measure: worlds whose links differ by more than the room need a tolerance that is set.
class FollowedLatency {
 public:
  /// Halves of round trips are averages of both ways, seen four times a second.
  static constexpr double room = 1.25;
  static constexpr std::int64_t hold_ticks = ticks_from_ms(5000);
  /// A stall that is longer is no latency to live with (ms): auras would reach through regions.
  static constexpr double latency_ms_max = 200;

  explicit FollowedLatency(const AuraTolerances& start) : in_force_(start) {}

  /// After each step, with the longest latency of any link; 0: nothing has been measured. Returns
  /// what holds from now on if that has changed.
  std::optional<AuraTolerances> step(Tick now, double longest_ms);

 private:
  AuraTolerances in_force_;
  std::optional<Tick> lower_since_;
  double highest_since_ms_ = 0;
};

}  // namespace aureole
