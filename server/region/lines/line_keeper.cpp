// Crowds are counted by distance; the line goes a step at a time.
#include "server/region/lines/line_keeper.h"

#include <algorithm>
#include <cmath>

#include "server/region/loads/smoothing.h"

namespace aureole {
namespace {

/// Crowds and loads follow who is awake in so many statuses, 5 s. Alike, so that what a crowd would
/// bring is compared with what there was at the same time.
constexpr double looks_in_mind = 20;

}  // namespace

LineKeeper::LineKeeper(const PartitionLines& lines, std::size_t regions, RegionId self)
    : lines_(lines), self_(self), loads_(regions) {
  for (std::uint16_t k = 0; k < regions; ++k) keepers_below_.push_back(RegionId{k});
  for (std::size_t i = 0; i < lines.count(); ++i) {
    const RegionId keeper = lines.below(i).front();
    for (const RegionId region : lines.above(i)) keepers_below_[region.value] = keeper;
    if (keeper == self) line_ = i;
    if (lines.above(i).front() == self) line_below_ = i;
  }
}

void LineKeeper::note_awake(std::span<const NewBody> awake) {
  loads_[self_.value].awake_now = static_cast<double>(awake.size());
  const double share = share_of_newest(++looks_, looks_in_mind);
  const auto count = [&](std::optional<std::size_t> line, Crowd& crowd) {
    if (!line) return;
    Crowd now;
    for (const NewBody& body : awake) {
      const double bin =
          (lines_.beyond_m(*line, body.state.position) - Crowd::from_m) / Crowd::bin_m;
      if (bin >= 0 && bin < Crowd::bins) ++now.awake[static_cast<std::size_t>(bin)];
    }
    crowd.follow(now, share);
  };
  count(line_, ends_);
  count(line_below_, begins_);
}

std::int32_t LineKeeper::gain() const {
  if (!target_m_) return 0;
  const LineSituation now{.below_has = ends_, .above_has = beyond_, .limits = {}};
  return static_cast<std::int32_t>(std::lround(std::clamp(now.gain(*target_m_), -1e6, 1e6)));
}

void LineKeeper::hear(RegionId from, double awake, std::int32_t gain, const Crowd& crowd_below) {
  Load& load = loads_[from.value];
  load.awake += (awake - load.awake) * share_of_newest(++load.looks, looks_in_mind);
  load.awake_now = awake;
  load.gain = gain;
  if (line_ && lines_.above(*line_).front() == from) beyond_ = crowd_below;
}

/// With what lines on their way will have brought.
double LineKeeper::expected(RegionId region) const {
  const RegionId below = keepers_below_[region.value];
  const Load& load = loads_[region.value];
  return load.awake + load.gain - (below == region ? 0 : loads_[below.value].gain);
}

LineSituation LineKeeper::situation(double here_m) const {
  LineSituation now;
  now.here_m = here_m;
  now.far_m = lines_.far_m(*line_);
  now.limits = limits_;
  now.below_has = ends_;
  now.above_has = beyond_;
  // But for our own line.
  now.below = expected(self_) - loads_[self_.value].gain;
  now.above = expected(lines_.above(*line_).front()) + loads_[self_.value].gain;
  for (const Load& load : loads_) now.all += load.awake;
  now.mean = now.all / static_cast<double>(loads_.size());
  return now;
}

bool LineKeeper::idle() const {
  double all = 0;
  for (const Load& load : loads_) all += load.awake_now;
  return all < awake_min_ * static_cast<double>(loads_.size());
}

double LineKeeper::next_m(double here_m) {
  if (!line_) return here_m;
  const LineSituation now = situation(here_m);
  if (idle() || now.mean < awake_min_) {
    target_m_.reset();  // When a world wakes again it may be another crowd.
    return here_m;
  }
  // Once it has set out it goes on, unless somebody would have too much by now.
  const bool on_its_way = target_m_ && *target_m_ != here_m && !overloads(now, *target_m_);
  if (!on_its_way) target_m_ = quiet_place_m(now);
  return here_m + std::clamp(*target_m_ - here_m, -step_m, step_m);
}

}  // namespace aureole
