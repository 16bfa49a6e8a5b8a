// How fast a body's surface moves: a capsule that rolls is slower than one that tumbles.
#include <algorithm>

#include "server/physics/shape.h"

namespace aureole {
namespace {

/// A point at the end of `arm` and at the end of its opposite, with all that is around it.
float fastest_around(const Eigen::Vector3f& velocity, const Eigen::Vector3f& spin,
                     const Eigen::Vector3f& arm, float radius) {
  const Eigen::Vector3f turned = spin.cross(arm);
  return std::max((velocity + turned).norm(), (velocity - turned).norm()) + spin.norm() * radius;
}

}  // namespace

float surface_speed(const Shape& shape, const Eigen::Quaternionf& orientation,
                    const Eigen::Vector3f& velocity_mps, const Eigen::Vector3f& spin_radps) {
  if (const auto* capsule = std::get_if<CapsuleShape>(&shape)) {
    const Eigen::Vector3f arm(0, std::max(0.f, capsule->height / 2 - capsule->radius), 0);
    return fastest_around(velocity_mps, spin_radps, orientation * arm, capsule->radius);
  }
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    const Eigen::Vector3f arm(0, cylinder->height / 2, 0);
    return fastest_around(velocity_mps, spin_radps, orientation * arm, cylinder->radius);
  }
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    float fastest = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3f signs(corner & 1 ? 1.f : -1.f, corner & 2 ? 1.f : -1.f, 1.f);
      const Eigen::Vector3f arm = orientation * signs.cwiseProduct(box->half_extents);
      fastest = std::max(fastest, fastest_around(velocity_mps, spin_radps, arm, 0));
    }
    return fastest;
  }
  return velocity_mps.norm() + spin_radps.norm() * bounding_radius(shape);
}

}  // namespace aureole
