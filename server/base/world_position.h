// A point of the whole world, as against a point of one region's physics.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace aureole {

/// World coordinates (unit: m): x and z span the ground plane, y is up. Doubles, so that worlds may
/// grow wider than floats resolve; physics works in floats around its own origin and converts at
/// its border.
struct WorldPosition {
  double x{}, y{}, z{};

  static WorldPosition from(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
  static WorldPosition from(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
  Eigen::Vector3d vector() const { return {x, y, z}; }
  /// This point seen from `origin`, in the precision of the physics.
  Eigen::Vector3f relative_to(const WorldPosition& origin) const {
    return (vector() - origin.vector()).cast<float>();
  }
  bool is_finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(z); }
  friend bool operator==(const WorldPosition&, const WorldPosition&) = default;
};

inline double distance(const WorldPosition& a, const WorldPosition& b) {
  return (a.vector() - b.vector()).norm();
}

}  // namespace aureole
