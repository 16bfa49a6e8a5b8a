// From levels to loads, from loads to lines.
#include "server/region/loads/home_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aureole {
namespace {

/// Between two levels.
constexpr double step = 1.0025;

/// The load follows what is awake in so many statuses: 20 s. Until then it is the mean of all.
constexpr double looks_in_mind = 78;

/// Lines move so much later than the order of the servers changes: what has to change its owner
/// because of the one need not at once because of the other.
constexpr std::int64_t after_order_ticks = LoadLevels::term_ticks / 2;

/// A load is no more than this many times what it was lately.
constexpr double calm_factor = 2;

/// Where a server has calmed down what wakes counts only after so long: 10 s. A heap that goes home
/// when lines come back wakes for a moment; they would move for it, come back, and so for ever.
constexpr std::int64_t lasting_ticks = 625;

}  // namespace

HomeLines::HomeLines(const PartitionMap& map, RegionId self, bool moves)
    : map_(map), self_(self), lines_(map), levels_(map.size(), self, step), moves_(moves) {}

void HomeLines::note_awake(std::size_t awake) {
  const double share = std::max(1.0 / static_cast<double>(++looks_), 1.0 / looks_in_mind);
  awake_ += (static_cast<double>(awake) - awake_) * share;
}

LoadLevels::Told HomeLines::tell(Tick now, double lately) {
  if (!moves_) return {};
  if (counted_ && !levels_.counts(lately)) calm_ = now;
  told_ = calm_ && now - *calm_ < lasting_ticks ? 0 : std::min(awake_, calm_factor * lately);
  counted_ = counted_ || levels_.counts(told_);
  LoadLevels::Told told = levels_.tell(now, told_);
  // Others know better than a server that has just started at which level it is.
  if (!levels_.knows(self_, now)) told.now = LoadLevels::unknown;
  return told;
}

void HomeLines::hear(RegionId from, Tick told_at, LoadLevels::Told told) {
  if (moves_) levels_.hear(from, told_at, told);
}

/// Of terms that have been left out nobody here knows what they asked for; before the first one
/// nothing was.
void HomeLines::begin_term(std::int64_t term) {
  const std::vector<double> none(lines_.count(), 0.0);
  if (term_ < 0) wanted_.fill({none, term == 0});
  for (; term_ < term; ++term_) {
    if (term_ + static_cast<std::int64_t>(terms_in_mind) < term)
      term_ = term - static_cast<std::int64_t>(terms_in_mind);
    std::rotate(wanted_.begin(), wanted_.end() - 1, wanted_.end());
    wanted_.front() = {wanted_[1].shifts_m, false};
  }
  term_ = term;
  levels_now_.clear();
}

/// Whether others are in force than at the last look.
bool HomeLines::look_up(Tick as_of) {
  Wanted& wanted = wanted_.front();
  wanted.sure = levels_.knows_all(as_of);
  const std::span<const std::uint16_t> levels = levels_.in_force(as_of);
  if (std::equal(levels.begin(), levels.end(), levels_now_.begin(), levels_now_.end()))
    return false;
  levels_now_.assign(levels.begin(), levels.end());
  std::vector<double> loads;
  for (const std::uint16_t level : levels) loads.push_back(std::pow(step, level));
  wanted.shifts_m = lines_.shifts_m(loads);
  return true;
}

bool HomeLines::move(Tick now) {
  if (!moves_) return false;
  const Tick as_of = now - after_order_ticks;
  if (const std::int64_t term = LoadLevels::term_of(as_of); term != term_) begin_term(term);
  const bool others_in_force = look_up(as_of);
  const bool sure =
      std::all_of(wanted_.begin(), wanted_.end(), [](const Wanted& wanted) { return wanted.sure; });
  // Two maps differ by no more than both shifts.
  const double margin_m = sure ? 0 : 2 * lines_.longest_shift_m();
  const bool surer = std::exchange(margin_m_, margin_m) != margin_m;
  if (!others_in_force) return surer;
  std::vector<double> shifts_m(lines_.count(), 0.0);
  for (const Wanted& wanted : wanted_)
    for (std::size_t i = 0; i < shifts_m.size(); ++i)
      shifts_m[i] += wanted.shifts_m[i] / static_cast<double>(terms_in_mind);
  std::vector<Rectangle> areas = lines_.areas(shifts_m);
  bool same = true;
  for (std::uint16_t k = 0; k < map_.size(); ++k) same &= areas[k] == map_.area(RegionId{k});
  if (same) return surer;
  map_ = PartitionMap(std::move(areas), map_.version() + 1);
  return true;
}

bool HomeLines::settled() const {
  const auto asks_nothing = [](const Wanted& wanted) {
    return std::all_of(wanted.shifts_m.begin(), wanted.shifts_m.end(),
                       [](double shift_m) { return shift_m == 0; });
  };
  return !levels_.counts(told_) && levels_.none_loaded() &&
         std::all_of(wanted_.begin(), wanted_.end(), asks_nothing);
}

}  // namespace aureole
