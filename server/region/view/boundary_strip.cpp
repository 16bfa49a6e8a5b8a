// A rectangle, and squares around whoever is inside it.
#include "server/region/view/boundary_strip.h"

#include <algorithm>
#include <cmath>

namespace aureole {

BoundaryStrip::BoundaryStrip(const PartitionMap& map, RegionId self)
    : area_(map.area(self)), inner_(area_) {}

std::int64_t BoundaryStrip::column(double x) const {
  return static_cast<std::int64_t>(std::floor((x - low_x_) / square_m));
}
std::int64_t BoundaryStrip::row(double z) const {
  return static_cast<std::int64_t>(std::floor((z - low_z_) / square_m));
}

void BoundaryStrip::note(std::span<const RemoteAura> remote, double depth_m) {
  inner_ = area_.inner(depth_m);
  visited_ = false;
  double high_x = 0, high_z = 0;
  reached_.clear();
  for (const RemoteAura& aura : remote) {
    const AuraBox box = aura.room.box();
    const double x = box.half.x() + depth_m, z = box.half.z() + depth_m;
    const Rectangle wide{box.centre.x() - x, box.centre.z() - z, box.centre.x() + x,
                         box.centre.z() + z};
    if (!inner_.overlaps(wide)) continue;
    low_x_ = visited_ ? std::min(low_x_, wide.min_x) : wide.min_x;
    low_z_ = visited_ ? std::min(low_z_, wide.min_z) : wide.min_z;
    high_x = visited_ ? std::max(high_x, wide.max_x) : wide.max_x;
    high_z = visited_ ? std::max(high_z, wide.max_z) : wide.max_z;
    visited_ = true;
    reached_.push_back(wide);
  }
  if (!visited_) return;
  // Wider than this nobody comes in; then everything counts.
  columns_ = column(high_x) + 1;
  rows_ = row(high_z) + 1;
  if (columns_ > side_max || rows_ > side_max) {
    marked_.clear();
    return;
  }
  marked_.assign(static_cast<std::size_t>(columns_ * rows_), 0);
  for (const Rectangle& wide : reached_) {
    const std::int64_t first = column(wide.min_x), last = column(wide.max_x);
    for (std::int64_t r = row(wide.min_z), end = row(wide.max_z); r <= end; ++r)
      std::fill_n(marked_.begin() + (r * columns_ + first), last - first + 1, std::uint8_t{1});
  }
}

bool BoundaryStrip::shows(const AuraBox& room) const {
  const bool all_is_strip = !(inner_.min_x < inner_.max_x && inner_.min_z < inner_.max_z);
  if (all_is_strip) return true;
  const double low_x = std::max(room.centre.x() - room.half.x(), inner_.min_x);
  const double low_z = std::max(room.centre.z() - room.half.z(), inner_.min_z);
  const double high_x = std::min(room.centre.x() + room.half.x(), inner_.max_x);
  const double high_z = std::min(room.centre.z() + room.half.z(), inner_.max_z);
  if (!(low_x < high_x && low_z < high_z)) return true;
  if (!visited_) return false;
  if (marked_.empty()) return true;
  // What is wider than all that is marked is not shown as a whole.
  if (high_x - low_x > square_m * static_cast<double>(columns_) ||
      high_z - low_z > square_m * static_cast<double>(rows_))
    return false;
  for (std::int64_t r = row(low_z); r <= row(high_z); ++r)
    for (std::int64_t c = column(low_x); c <= column(high_x); ++c)
      if (!is_marked(c, r)) return false;
  return true;
}

bool BoundaryStrip::is_marked(std::int64_t c, std::int64_t r) const {
  if (marked_.empty()) return true;
  return c >= 0 && c < columns_ && r >= 0 && r < rows_ &&
         marked_[static_cast<std::size_t>(r * columns_ + c)] != 0;
}

}  // namespace aureole
