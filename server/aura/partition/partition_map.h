// Which region server answers for which part of the ground plane: data with a version, never baked
// in.
#pragma once

#include <cstdint>
#include <vector>

#include "server/aura/shapes/rectangle.h"
#include "server/base/ids.h"

namespace aureole {

/// A piece of a vertical plane between two regions. One of the coordinates is constant.
struct BoundarySegment {
  RegionId first, second;                             ///< first < second
  double from_x = 0, from_z = 0, to_x = 0, to_z = 0;  ///< May be infinite along the segment.
};

/// The areas tile the plane (checked where worlds are read), so that each point has exactly one
/// owner.
class PartitionMap {
 public:
  explicit PartitionMap(std::vector<Rectangle> areas, std::uint64_t version = 1);

  std::uint64_t version() const { return version_; }
  std::size_t size() const { return areas_.size(); }
  const Rectangle& area(RegionId region) const { return areas_[region.value]; }

  /// The region whose area holds the point. Points that are not finite belong to region 0.
  RegionId region_at(double x, double z) const;
  /// Regions whose areas come within `radius` of the point, ascending.
  std::vector<RegionId> regions_within(double x, double z, double radius) const;
  /// The next version of the map, with lines moved. Who has been a neighbour stays one, though two
  /// regions that met at a corner may have none in common any more.
  PartitionMap moved(std::vector<Rectangle> areas) const;
  /// Regions that share an edge or a corner with `region`, ascending.
  const std::vector<RegionId>& neighbours(RegionId region) const {
    return neighbours_[region.value];
  }
  /// Whether three regions meet anywhere.
  bool has_corners() const { return has_corners_; }
  /// All pieces of boundary, sorted by their regions. At a T-shaped corner one side's edge is cut
  /// into the pieces that its neighbours touch.
  const std::vector<BoundarySegment>& boundaries() const { return boundaries_; }

 private:
  bool finds_corners() const;

  std::vector<Rectangle> areas_;
  std::uint64_t version_;
  std::vector<std::vector<RegionId>> neighbours_;
  std::vector<BoundarySegment> boundaries_;
  bool has_corners_ = false;
};

}  // namespace aureole
