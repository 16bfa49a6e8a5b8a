// Up at once, down after a while, in whole steps.
#include "server/region/tolerances/followed_latency.h"

#include <algorithm>

namespace aureole {

std::optional<AuraTolerances> FollowedLatency::step(Tick now, double longest_ms) {
  if (longest_ms <= 0) return {};
  AuraTolerances wanted = in_force_;
  wanted.latency_ms = std::min(longest_ms * room, latency_ms_max);
  wanted.latency_ms = steps_in_flight(wanted) * (tick_us / 1e3) - 2 * wanted.frame_time_ms;
  if (wanted.latency_ms == in_force_.latency_ms) {
    lower_since_.reset();
    return {};
  }
  if (wanted.latency_ms < in_force_.latency_ms) {
    if (!lower_since_) {
      lower_since_ = now;
      highest_since_ms_ = 0;
    }
    highest_since_ms_ = std::max(highest_since_ms_, wanted.latency_ms);
    if (now - *lower_since_ < hold_ticks) return {};
    wanted.latency_ms = highest_since_ms_;
  }
  lower_since_.reset();
  in_force_ = wanted;
  return in_force_;
}

}  // namespace aureole
