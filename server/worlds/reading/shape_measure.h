// What a world file needs to know of shapes: volume, centre of mass, and how far they reach.
#pragma once

#include <optional>
#include <span>

#include "server/physics/shape.h"

namespace aureole {

struct VolumeAndCentre {
  double volume_m3 = 0;
  Eigen::Vector3d centre{0, 0, 0};
};

/// Of the convex hull of the points at even density; nothing if they lie in one plane (to one part
/// in 10^5 of their extent). Incremental hull: each point outside replaces the faces it sees.
std::optional<VolumeAndCentre> convex_hull_volume(std::span<const Eigen::Vector3f> points);

/// At even density, about the shape's own origin. A plane has none: AUREOLE_CHECK.
VolumeAndCentre volume_and_centre(const Shape& shape);

/// How far the shape, turned by `orientation` about its origin, reaches along each world axis
/// (unit: m): exact for every shape but the plane (AUREOLE_CHECK).
struct Reach {
  Eigen::Vector3f min{0, 0, 0}, max{0, 0, 0};
  Eigen::Vector3f size() const { return max - min; }
};
Reach reach_of(const Shape& shape, const Eigen::Quaternionf& orientation);

}  // namespace aureole
