// A load counts when it lasts.
#include "server/region/loads/lasting_load.h"

#include <algorithm>
#include <cmath>

#include "server/region/loads/smoothing.h"

namespace aureole {
namespace {

/// Loads are smoothed over so many statuses: 20 s.
constexpr double looks_in_mind = 78;

/// What has been too much for so many statuses, 30 s, counts in full. Lines answer some 7 s later:
/// with less they would overshoot.
constexpr double looks_to_sum_up = 117;

/// A difference counts as no more than this; and what it has come to goes back by itself in two
/// minutes, and is never more than that, so that what is over is soon forgotten.
constexpr double difference_max = 0.2, excess_max = 0.25, looks_to_forget = 469;

/// Nobody pushes harder than with so many times its own load: who has far less than the others does
/// not wait until the differences have been summed up.
constexpr double own_factor = 2;

/// Who has less than one part in so many of its own load still awake pushes that much less at once.
constexpr double calm_factor = 2;

/// Where a server has calmed down what wakes counts only after so long: 10 s.
constexpr std::int64_t lasting_ticks = 625;

}  // namespace

void LastingLoad::note_awake(double lately, double mean) {
  const double newest = share_of_newest(++looks_, looks_in_mind);
  own_ += (lately - own_) * newest;
  mean_ += (mean - mean_) * newest;
  excess_ -= excess_ / looks_to_forget;
  if (lately <= 0 || mean <= 0) return;
  const double difference = std::clamp(std::log(lately / mean), -difference_max, difference_max);
  excess_ = std::clamp(excess_ + difference / looks_to_sum_up, -excess_max, excess_max);
}

double LastingLoad::tell(Tick now, double lately, const LoadLevels& levels) {
  if (counted_ && !levels.counts(lately)) {
    calm_ = now;
    excess_ = 0;
  }
  const bool calm = calm_ && now - *calm_ < lasting_ticks;
  const double lasting = std::min(mean_ * std::exp(excess_), own_factor * own_);
  const bool calms_down = calm_factor * lately < own_;
  told_ = calm ? 0 : calms_down ? lasting * calm_factor * lately / own_ : lasting;
  counted_ = counted_ || levels.counts(told_);
  return told_;
}

}  // namespace aureole
