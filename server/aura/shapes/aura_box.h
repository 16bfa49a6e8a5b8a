// Boxes around auras: what is compared before anything more exact.
#pragma once

#include <Eigen/Core>
#include <array>

#include "server/aura/shapes/rectangle.h"

namespace aureole {

/// Axis-aligned box in world coordinates (unit: m). Half extents ≥ 0.
struct AuraBox {
  Eigen::Vector3d centre{0, 0, 0};
  Eigen::Vector3d half{0, 0, 0};
  bool overlaps(const AuraBox& other) const {
    return std::abs(centre.x() - other.centre.x()) <= half.x() + other.half.x() &&
           std::abs(centre.z() - other.centre.z()) <= half.z() + other.half.z() &&
           std::abs(centre.y() - other.centre.y()) <= half.y() + other.half.y();
  }
};

/// The ground that it stands on or over.
inline Rectangle footprint(const AuraBox& box) {
  return {box.centre.x() - box.half.x(), box.centre.z() - box.half.z(),
          box.centre.x() + box.half.x(), box.centre.z() + box.half.z()};
}

/// The box around both.
inline AuraBox joined(const AuraBox& a, const AuraBox& b) {
  const Eigen::Vector3d low = (a.centre - a.half).cwiseMin(b.centre - b.half);
  const Eigen::Vector3d high = (a.centre + a.half).cwiseMax(b.centre + b.half);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

/// Corners as floats, rounded outwards by a millionth part: half the memory.
struct RoughBox {
  std::array<float, 3> low, high;  ///< x, y, z (m)
  static RoughBox around(const AuraBox& box);
  bool meets(const RoughBox& other) const {
    const bool x = (low[0] <= other.high[0]) & (other.low[0] <= high[0]);
    const bool y = (low[1] <= other.high[1]) & (other.low[1] <= high[1]);
    const bool z = (low[2] <= other.high[2]) & (other.low[2] <= high[2]);
    return x & y & z;
  }
};

}  // namespace aureole
