// The segment that a shape lies around.
#include <algorithm>

#include "server/physics/shape.h"

namespace aureole {

Spine spine(const Shape& shape) {
  if (const auto* capsule = std::get_if<CapsuleShape>(&shape))
    return {{0, std::max(0.f, capsule->height / 2 - capsule->radius), 0},
            capsule->radius,
            capsule->radius};
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return {{0, cylinder->height / 2, 0},
            cylinder->radius,
            std::min(cylinder->radius, cylinder->height / 2)};
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    Eigen::Index longest;
    box->half_extents.maxCoeff(&longest);
    Eigen::Vector3f along(0, 0, 0), across = box->half_extents;
    std::swap(along[longest], across[longest]);
    return {along, across.norm(), box->half_extents.minCoeff()};
  }
  const float radius = bounding_radius(shape);
  return {{0, 0, 0}, radius, std::holds_alternative<SphereShape>(shape) ? radius : 0.f};
}

}  // namespace aureole
