// From levels to loads, from loads to lines.
#include "server/region/lines/home_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aureole {
namespace {

/// Between two levels.
constexpr double step = 1.0025;

/// What a body awake takes of a frame besides physics grows with the neighbours that hear of it: by
/// so much of its physics for each of them (measured at a corner of nine).
constexpr double frame_of_neighbour = 0.006;

/// Lines move so much later than the order of the servers changes: what has to change its owner
/// because of the one need not at once because of the other.
constexpr std::int64_t after_order_ticks = LoadLevels::term_ticks / 2;

}  // namespace

HomeLines::HomeLines(const PartitionMap& map, RegionId self, Rule rule)
    : map_(map),
      self_(self),
      lines_(map),
      levels_(map.size(), self, step),
      rule_(rule),
      keeper_(lines_, map.size(), self) {
  const std::vector<RegionId>& neighbours = map.neighbours(self);
  const auto is_near = [&](RegionId region) {
    return region == self || std::binary_search(neighbours.begin(), neighbours.end(), region);
  };
  for (std::size_t i = 0; i < lines_.count(); ++i)
    if (is_near(lines_.below(i).front()) || is_near(lines_.above(i).front()))
      keepers_near_.push_back(lines_.below(i).front());
  for (std::uint16_t k = 0; k < map.size(); ++k)
    frame_of_body_.push_back(1 + frame_of_neighbour *
                                     static_cast<double>(map.neighbours(RegionId{k}).size()));
}

void HomeLines::note_awake(std::span<const NewBody> awake, std::span<const double> everywhere) {
  awake_now_ = static_cast<double>(awake.size());
  if (rule_ == Rule::quiet_places) keeper_.note_awake(awake);
  if (rule_ != Rule::even_loads) return;
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < everywhere.size(); ++k) {
    if (!levels_.counts(everywhere[k])) continue;
    sum += everywhere[k] * frame_of_body_[k];
    ++count;
  }
  const std::uint16_t self = self_.value;
  load_.note_awake(everywhere[self] * frame_of_body_[self], count > 0 ? sum / count : 0);
}

/// Levels of lines: 0 is the place in the map, then steps up and down in turns.
double HomeLines::place_m(std::size_t line, std::uint16_t level) const {
  const double steps = level % 2 == 0 ? level / 2 : -(level + 1) / 2;
  const double far_m = lines_.far_m(line);
  return std::clamp(steps * PartitionLines::grain_m, -far_m, far_m);
}

std::uint16_t HomeLines::level_at(double place_m) {
  const long steps = std::lround(place_m / PartitionLines::grain_m);
  return static_cast<std::uint16_t>(steps >= 0 ? 2 * steps : -2 * steps - 1);
}

/// Who has started anew does not know where its line lies before somebody has told it; if nobody
/// has within three terms nobody knows.
LoadLevels::Told HomeLines::tell_place(Tick now) {
  if (!keeper_.line()) return levels_.tell(now, [](std::uint16_t) { return std::uint16_t{0}; });
  if (!first_told_) first_told_ = now;
  if (LoadLevels::term_of(now) > 0 && !levels_.has_heard(self_) &&
      now - *first_told_ < 3 * LoadLevels::term_ticks)
    return {LoadLevels::unknown, LoadLevels::unknown};
  return levels_.tell(now, [&](std::uint16_t before) {
    // Who does not hear of everybody may not be heard by everybody.
    if (!levels_.knows_all(now)) return before;
    return level_at(keeper_.next_m(place_m(*keeper_.line(), before)));
  });
}

LineNews HomeLines::tell_of_row(Tick now) {
  LineNews news{.level = tell_place(now)};
  news.crowd_below = keeper_.crowd_below();
  news.gain = keeper_.gain();
  news.awake = awake_now_;
  if (const auto below = keeper_.keeper_below_of(self_); below && levels_.has_heard(*below))
    news.level_below = levels_.in_force(now)[below->value];
  keeper_.hear(self_, news.awake, news.gain, news.crowd_below);
  return news;
}

LineNews HomeLines::tell(Tick now, double lately) {
  if (rule_ == Rule::still) return {};
  if (rule_ == Rule::quiet_places) return tell_of_row(now);
  LoadLevels::Told told = levels_.tell(now, load_.tell(now, lately, levels_));
  // Others know better than a server that has just started at which level it is.
  if (!levels_.knows(self_, now)) told.now = LoadLevels::unknown;
  return {.level = told};
}

void HomeLines::hear(RegionId from, Tick told_at, const LineNews& told) {
  if (rule_ == Rule::still) return;
  levels_.hear(from, told_at, told.level);
  if (rule_ != Rule::quiet_places) return;
  keeper_.hear(from, told.awake, told.gain, told.crowd_below);
  // As good as heard of a term ago: it may have moved since.
  const std::int64_t term = LoadLevels::term_of(told_at);
  if (const auto keeper = keeper_.keeper_below_of(from);
      keeper && told.level_below != LoadLevels::unknown && term > 0 && !levels_.has_heard(*keeper))
    levels_.hear(*keeper, Tick{(term - 1) * LoadLevels::term_ticks},
                 {told.level_below, LoadLevels::unknown});
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

/// Whether all is known that our region's edges and its neighbours' depend on: in a row the lines
/// there, around a corner everybody's loads.
bool HomeLines::knows_near(Tick as_of) const {
  if (rule_ == Rule::even_loads) return levels_.knows_all(as_of);
  return std::all_of(keepers_near_.begin(), keepers_near_.end(),
                     [&](RegionId keeper) { return levels_.knows(keeper, as_of); });
}

/// Whether others are in force than at the last look.
bool HomeLines::look_up(Tick as_of) {
  Wanted& wanted = wanted_.front();
  wanted.sure = knows_near(as_of);
  const std::span<const std::uint16_t> levels = levels_.in_force(as_of);
  if (std::equal(levels.begin(), levels.end(), levels_now_.begin(), levels_now_.end()))
    return false;
  levels_now_.assign(levels.begin(), levels.end());
  if (rule_ == Rule::quiet_places) {
    for (std::size_t i = 0; i < lines_.count(); ++i)
      wanted.shifts_m[i] = place_m(i, levels[lines_.below(i).front().value]);
    // Lines go by steps: of terms that nothing is known of what is known now says more than
    // nothing.
    for (Wanted& before : wanted_)
      if (!before.sure) before.shifts_m = wanted.shifts_m;
    return true;
  }
  std::vector<double> loads;
  for (const std::uint16_t level : levels) loads.push_back(std::pow(step, level));
  wanted.shifts_m = lines_.shifts_m(loads);
  return true;
}

/// As far as two maps may differ.
double HomeLines::margin_m(bool sure) const {
  if (sure) return 0;
  if (rule_ == Rule::even_loads) return 2 * lines_.longest_shift_m();
  double longest_m = 0;
  bool heard = true;
  for (std::size_t i = 0; i < lines_.count(); ++i) longest_m = std::max(longest_m, lines_.far_m(i));
  for (const RegionId keeper : keepers_near_) heard &= levels_.has_heard(keeper);
  // Who does not hear of everybody does not move its line: it goes two steps at most before that.
  return 2 * (heard ? std::min(2 * LineKeeper::step_m, longest_m) : longest_m);
}

bool HomeLines::move(Tick now) {
  if (rule_ == Rule::still) return false;
  const Tick as_of = now - after_order_ticks;
  if (const std::int64_t term = LoadLevels::term_of(as_of); term != term_) begin_term(term);
  const bool others_in_force = look_up(as_of);
  const bool sure =
      std::all_of(wanted_.begin(), wanted_.end(), [](const Wanted& wanted) { return wanted.sure; });
  const double margin = margin_m(sure);
  const bool surer = std::exchange(margin_m_, margin) != margin;
  if (!others_in_force) return surer;
  std::vector<double> shifts_m(lines_.count(), 0.0);
  for (const Wanted& wanted : wanted_)
    for (std::size_t i = 0; i < shifts_m.size(); ++i)
      shifts_m[i] += wanted.shifts_m[i] / static_cast<double>(terms_in_mind);
  std::vector<Rectangle> areas = lines_.areas(shifts_m);
  bool same = true;
  for (std::uint16_t k = 0; k < map_.size(); ++k) same &= areas[k] == map_.area(RegionId{k});
  if (same) return surer;
  map_ = map_.moved(std::move(areas));
  return true;
}

bool HomeLines::settled() const {
  if (rule_ == Rule::quiet_places)
    return keeper_.idle() && levels_.unchanged() &&
           std::all_of(wanted_.begin(), wanted_.end(), [&](const Wanted& wanted) {
             return wanted.shifts_m == wanted_.front().shifts_m;
           });
  const auto asks_nothing = [](const Wanted& wanted) {
    return std::all_of(wanted.shifts_m.begin(), wanted.shifts_m.end(),
                       [](double shift_m) { return shift_m == 0; });
  };
  return !levels_.counts(load_.told()) && levels_.none_loaded() &&
         std::all_of(wanted_.begin(), wanted_.end(), asks_nothing);
}

}  // namespace aureole
