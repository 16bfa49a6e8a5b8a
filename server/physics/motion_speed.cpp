// How fast a body's room moves: a ball or a log that rolls is slower than one that tumbles.
#include <algorithm>
#include <cmath>

#include "server/physics/shape.h"

namespace aureole {
namespace {

/// Turning about an axis of symmetry moves nothing out of its place; all it can do is become
/// motion, at a contact: with inertia k m r² no more speed than sqrt(k) r ω comes of it.
constexpr float ball_inertia = 0.4f, log_inertia = 0.5f;

float with_spin(float speed, float inertia, float radius, float spin) {
  return std::sqrt(speed * speed + inertia * radius * radius * spin * spin);
}

/// The ends of something round of `half_length` to either side, along y in its own frame.
float speed_of_log(const Eigen::Quaternionf& orientation, const Eigen::Vector3f& velocity,
                   const Eigen::Vector3f& spin, float half_length, float radius) {
  const Eigen::Vector3f axis = orientation * Eigen::Vector3f::UnitY();
  const float about_axis = spin.dot(axis);
  const Eigen::Vector3f tumbling = spin - about_axis * axis;
  const Eigen::Vector3f end = tumbling.cross(half_length * axis);
  const float ends = std::max((velocity + end).norm(), (velocity - end).norm());
  return with_spin(ends + tumbling.norm() * radius, log_inertia, radius, about_axis);
}

}  // namespace

float motion_speed(const Shape& shape, const Eigen::Quaternionf& orientation,
                   const Eigen::Vector3f& velocity_mps, const Eigen::Vector3f& spin_radps) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return with_spin(velocity_mps.norm(), ball_inertia, sphere->radius, spin_radps.norm());
  if (const auto* capsule = std::get_if<CapsuleShape>(&shape))
    return speed_of_log(orientation, velocity_mps, spin_radps,
                        std::max(0.f, capsule->height / 2 - capsule->radius), capsule->radius);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return speed_of_log(orientation, velocity_mps, spin_radps, cylinder->height / 2,
                        cylinder->radius);
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    float fastest = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3f signs(corner & 1 ? 1.f : -1.f, corner & 2 ? 1.f : -1.f, 1.f);
      const Eigen::Vector3f turned =
          spin_radps.cross(orientation * signs.cwiseProduct(box->half_extents));
      fastest = std::max({fastest, (velocity_mps + turned).norm(), (velocity_mps - turned).norm()});
    }
    return fastest;
  }
  return velocity_mps.norm() + spin_radps.norm() * bounding_radius(shape);
}

}  // namespace aureole
