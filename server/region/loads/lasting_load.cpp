// A load counts when it lasts.
#include "server/region/loads/lasting_load.h"

#include <algorithm>

#include "server/region/loads/smoothing.h"

namespace aureole {
namespace {

/// The load follows what is awake in so many statuses: 20 s.
constexpr double looks_in_mind = 78;

/// A load is no more than this many times what it was lately.
constexpr double calm_factor = 2;

/// Where a server has calmed down what wakes counts only after so long: 10 s.
constexpr std::int64_t lasting_ticks = 625;

}  // namespace

void LastingLoad::note_awake(double awake) {
  awake_ += (awake - awake_) * share_of_newest(++looks_, looks_in_mind);
}

double LastingLoad::tell(Tick now, double lately, const LoadLevels& levels) {
  if (counted_ && !levels.counts(lately)) calm_ = now;
  told_ = calm_ && now - *calm_ < lasting_ticks ? 0 : std::min(awake_, calm_factor * lately);
  counted_ = counted_ || levels.counts(told_);
  return told_;
}

}  // namespace aureole
