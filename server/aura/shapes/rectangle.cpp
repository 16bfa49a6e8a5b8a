// How far rectangles are apart.
#include "server/aura/shapes/rectangle.h"

#include <algorithm>
#include <cmath>

namespace aureole {

double Rectangle::distance(double x, double z) const {
  const double dx = std::max({min_x - x, x - max_x, 0.0});
  const double dz = std::max({min_z - z, z - max_z, 0.0});
  // Lengths in a world neither burst nor vanish when they are squared.
  return std::sqrt(dx * dx + dz * dz);
}

double Rectangle::distance(const Rectangle& other) const {
  const double dx = std::max({other.min_x - max_x, min_x - other.max_x, 0.0});
  const double dz = std::max({other.min_z - max_z, min_z - other.max_z, 0.0});
  return std::hypot(dx, dz);
}

}  // namespace aureole
