// Pieces of the ground plane.
#pragma once

#include <limits>

namespace aureole {

/// Half-open rectangle [min, max) of the ground plane (unit: m); without bounds unless they are
/// given.
struct Rectangle {
  double min_x = -std::numeric_limits<double>::infinity();
  double min_z = -std::numeric_limits<double>::infinity();
  double max_x = std::numeric_limits<double>::infinity();
  double max_z = std::numeric_limits<double>::infinity();

  bool contains(double x, double z) const {
    return x >= min_x && x < max_x && z >= min_z && z < max_z;
  }
  /// Whether any point of the other one, its edges included, is in it.
  bool overlaps(const Rectangle& closed) const {
    return closed.min_x < max_x && closed.max_x >= min_x && closed.min_z < max_z &&
           closed.max_z >= min_z;
  }
  /// Whether all of the other one is in it, its edges included.
  bool holds(const Rectangle& closed) const {
    return closed.min_x >= min_x && closed.max_x < max_x && closed.min_z >= min_z &&
           closed.max_z < max_z;
  }
  /// Without what is less than `depth_m` from its edges; holds nothing if that is all of it.
  Rectangle inner(double depth_m) const {
    return {min_x + depth_m, min_z + depth_m, max_x - depth_m, max_z - depth_m};
  }
  /// Between their nearest points; 0 if they overlap or share an edge (unit: m).
  double distance(const Rectangle& other) const;
  /// Distance from the point to the rectangle; 0 inside and on its edge (unit: m).
  double distance(double x, double z) const;
  friend bool operator==(const Rectangle&, const Rectangle&) = default;
};

}  // namespace aureole
