// Levels are chosen by who is loaded, and looked up by everybody.
#include "server/region/loads/load_levels.h"

#include <algorithm>
#include <cmath>

#include "server/aura/migration_policy.h"

namespace aureole {
void LoadLevels::note(Known& known, Announced announced) {
  const auto same = std::find_if(known.begin(), known.end(),
                                 [&](const Announced& a) { return a.term == announced.term; });
  if (same != known.end()) {
    same->level = announced.level;
  } else if (announced.term > known.front().term) {
    std::rotate(known.begin(), known.end() - 1, known.end());
    known.front() = announced;
  } else {
    // Older than all that is known: its time began anew.
    known = {announced, announced, announced};
  }
}

std::uint16_t LoadLevels::level_in(const Known& known, std::int64_t term) {
  const auto at =
      std::find_if(known.begin(), known.end(), [&](const Announced& a) { return a.term <= term; });
  return at == known.end() ? known.back().level : at->level;
}

std::uint16_t LoadLevels::level_for(double awake, double largest, std::uint16_t before) const {
  const double steps = std::log(std::max(awake / awake_min_, 1.0)) / std::log(step_);
  const double awake_before = awake_min_ * std::pow(step_, before);
  if (std::abs(steps - before) < 1 || std::abs(awake - awake_before) < largest) return before;
  return static_cast<std::uint16_t>(std::min(std::round(steps), double{last - 1}));
}

bool LoadLevels::is_to_choose(Tick now) const {
  return now.value % term_ticks >= term_ticks / 2 &&
         known_[self_.value].front().term <= term_of(now);
}

LoadLevels::Told LoadLevels::tell(Tick now, double awake, double largest) {
  return tell(now, [&](std::uint16_t before) { return level_for(awake, largest, before); });
}

LoadLevels::Told LoadLevels::tell(
    Tick now, const std::function<std::uint16_t(std::uint16_t before)>& choose) {
  const std::int64_t term = term_of(now);
  Known& ours = known_[self_.value];
  Told told{level_in(ours, term), unknown};
  if (now.value % term_ticks < term_ticks / 2) return told;
  if (is_to_choose(now)) note(ours, {term + 1, choose(told.now)});
  told.next = ours.front().level;
  return told;
}

void LoadLevels::hear(RegionId from, Tick told_at, Told told) {
  const std::int64_t term = term_of(told_at);
  if (told.now != unknown) note(known_[from.value], {term, told.now});
  if (told.next != unknown) note(known_[from.value], {term + 1, told.next});
}

bool LoadLevels::knows(RegionId region, Tick now) const {
  const Known& known = known_[region.value];
  return std::any_of(known.begin(), known.end(),
                     [&](const Announced& a) { return a.term == term_of(now); });
}

bool LoadLevels::knows_all(Tick now) const {
  for (std::uint16_t k = 0; k < known_.size(); ++k)
    if (!knows(RegionId{k}, now)) return false;
  return true;
}

bool LoadLevels::none_loaded() const {
  return std::all_of(known_.begin(), known_.end(), [](const Known& known) {
    return std::all_of(known.begin(), known.end(), [](const Announced& a) { return a.level == 0; });
  });
}

bool LoadLevels::unchanged() const {
  return std::all_of(known_.begin(), known_.end(), [](const Known& known) {
    return std::all_of(known.begin(), known.end(),
                       [&](const Announced& a) { return a.level == known.front().level; });
  });
}

void LoadLevels::look_up(Tick at, std::vector<std::uint16_t>& levels) const {
  levels.clear();
  for (const Known& known : known_) levels.push_back(level_in(known, term_of(at)));
}

std::span<const std::uint16_t> LoadLevels::in_force(Tick now) {
  look_up(now, in_force_);
  return in_force_;
}

std::span<const std::uint16_t> LoadLevels::in_force_before(Tick now) {
  look_up(now - long_stay_ticks, in_force_before_);
  return in_force_before_;
}

}  // namespace aureole
