// Lines that move at once for what stays, and slowly for what is given away.
#include "server/aura/adaptive/home_lines.h"

#include <algorithm>

namespace aureole {
namespace {

/// The lasting shift follows the present one in so many looks: four seconds.
constexpr double looks = 64;

/// How much of the way to the line what is given away lies.
constexpr double given_share = 0.5;

/// Nearer than this to a third region nothing is given away (m).
constexpr double third_region_m = 20;

}  // namespace

void HomeLines::look(const MigrationSituation& situation) {
  situation_ = &situation;
  if (map_version_ != situation.map.version()) {
    map_version_ = situation.map.version();
    has_corners_ = situation.map.has_corners();
  }
  const std::size_t self = situation.self.value;
  shifts_m_.assign(situation.map.size(), 0);
  lasting_shifts_m_.resize(situation.map.size(), 0);
  for (std::size_t k = 0; k < situation.awake.size(); ++k) {
    if (k == self) continue;
    shifts_m_[k] = line_shift_m({situation.awake[self], 0}, {situation.awake[k], 0});
    double& lasting_m = lasting_shifts_m_[k];
    lasting_m += (shifts_m_[k] - lasting_m) / looks;
    // A world that calms down comes home at once; and see `has_corners_`.
    if (shifts_m_[k] == 0 || !has_corners_) lasting_m = 0;
  }
  gives_ = std::any_of(lasting_shifts_m_.begin(), lasting_shifts_m_.end(),
                       [](double shift) { return shift > 0; });
}

RegionId HomeLines::home_of(const WorldPosition& at, bool rests) const {
  const PartitionMap& map = situation_->map;
  const RegionId self = situation_->self;
  const RegionId here = map.region_at(at.x, at.z);
  if (here == self) return rests || !gives_ ? self : given_to(at);
  const double kept_m = -std::min(shifts_m_[here.value], lasting_shifts_m_[here.value]);
  return map.area(self).distance(at.x, at.z) < kept_m ? self : here;
}

/// Of what lies in our region and stirs.
RegionId HomeLines::given_to(const WorldPosition& at) const {
  const PartitionMap& map = situation_->map;
  RegionId home = situation_->self;
  for (const RegionId region : map.neighbours(home)) {
    const double away_m = map.area(region).distance(at.x, at.z);
    if (away_m >= third_region_m) continue;
    if (home != situation_->self) return situation_->self;
    const double shift_m = std::min(shifts_m_[region.value], lasting_shifts_m_[region.value]);
    if (!situation_->linked[region.value] || away_m >= given_share * shift_m)
      return situation_->self;
    home = region;
  }
  return home;
}

}  // namespace aureole
