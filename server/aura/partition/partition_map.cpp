// Geometry of regions: ownership of points, neighbours, and the boundaries between them.
#include "server/aura/partition/partition_map.h"

#include <algorithm>
#include <cmath>

#include "server/base/check.h"

namespace aureole {
namespace {

/// Lengths that two ranges share; negative if they are apart.
double overlap(double a_min, double a_max, double b_min, double b_max) {
  return std::min(a_max, b_max) - std::max(a_min, b_min);
}

}  // namespace

PartitionMap::PartitionMap(std::vector<Rectangle> areas, std::uint64_t version)
    : areas_(std::move(areas)), version_(version), neighbours_(areas_.size()) {
  AUREOLE_CHECK(!areas_.empty(), "a world has at least one region");
  for (std::size_t i = 0; i < areas_.size(); ++i) {
    for (std::size_t j = i + 1; j < areas_.size(); ++j) {
      const Rectangle &a = areas_[i], &b = areas_[j];
      const double shared_x = overlap(a.min_x, a.max_x, b.min_x, b.max_x);
      const double shared_z = overlap(a.min_z, a.max_z, b.min_z, b.max_z);
      if (shared_x < 0 || shared_z < 0) continue;
      const RegionId first{static_cast<std::uint16_t>(i)}, second{static_cast<std::uint16_t>(j)};
      neighbours_[i].push_back(second);
      neighbours_[j].push_back(first);
      const double min_x = std::max(a.min_x, b.min_x), max_x = std::min(a.max_x, b.max_x);
      const double min_z = std::max(a.min_z, b.min_z), max_z = std::min(a.max_z, b.max_z);
      // A shared corner is a neighbourhood, but no boundary of any length.
      if (shared_x > 0 || shared_z > 0)
        boundaries_.push_back({first, second, min_x, min_z, max_x, max_z});
    }
  }
  for (auto& list : neighbours_) std::sort(list.begin(), list.end());
  has_corners_ = finds_corners();
}

PartitionMap PartitionMap::moved(std::vector<Rectangle> areas) const {
  AUREOLE_CHECK(areas.size() == areas_.size(), "every region has an area");
  PartitionMap next(std::move(areas), version_ + 1);
  next.neighbours_ = neighbours_;
  next.has_corners_ = has_corners_;
  return next;
}

bool PartitionMap::finds_corners() const {
  const auto meets = [&](RegionId a, RegionId b) {
    return std::binary_search(neighbours_[a.value].begin(), neighbours_[a.value].end(), b);
  };
  // Rectangles of which any two touch have a point in common (Helly's theorem for boxes).
  for (std::uint16_t i = 0; i < areas_.size(); ++i)
    for (const RegionId j : neighbours_[i])
      for (const RegionId k : neighbours_[i])
        if (j < k && meets(j, k)) return true;
  return false;
}

RegionId PartitionMap::region_at(double x, double z) const {
  for (std::size_t i = 0; i < areas_.size(); ++i)
    if (areas_[i].contains(x, z)) return RegionId{static_cast<std::uint16_t>(i)};
  return RegionId{0};
}

std::vector<RegionId> PartitionMap::regions_within(double x, double z, double radius) const {
  std::vector<RegionId> found;
  for (std::size_t i = 0; i < areas_.size(); ++i)
    if (areas_[i].distance(x, z) <= radius)
      found.push_back(RegionId{static_cast<std::uint16_t>(i)});
  return found;
}

}  // namespace aureole
