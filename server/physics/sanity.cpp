// What a state or a contact must fulfil before Bullet may see it, whoever sent it.
#include <cmath>

#include "server/physics/physics_world.h"

namespace aureole {
namespace {

bool in_range(std::int16_t child) {
  return child >= -1;
}

/// Zero times anything is zero, unless that is infinite or not a number.
float zero_if_finite(const Eigen::Vector3f& v) {
  return 0 * v.x() + 0 * v.y() + 0 * v.z();
}

bool is_sane(const ContactPoint& p) {
  const bool finite = p.local_on_a.allFinite() && p.local_on_b.allFinite() &&
                      p.normal_on_b.allFinite() && p.lateral_1.allFinite() &&
                      p.lateral_2.allFinite() && std::isfinite(p.distance) &&
                      std::isfinite(p.impulse) && std::isfinite(p.impulse_lateral_1) &&
                      std::isfinite(p.impulse_lateral_2);
  return finite && std::abs(p.normal_on_b.norm() - 1) <= 1e-3f && p.impulse >= 0 &&
         p.age_steps >= 0 && in_range(p.child_a) && in_range(p.child_b);
}

}  // namespace

bool is_sane(const BodyState& state) {
  const WorldPosition& at = state.position;
  // All at once and not one after the other: every body that is awake is asked in every step.
  const float zeros = zero_if_finite(state.linear_velocity) +
                      zero_if_finite(state.angular_velocity) + 0 * state.deactivation_time_s;
  const bool finite = (0 * at.x + 0 * at.y + 0 * at.z == 0) & (zeros == 0);
  // What is not a number, or burst, has no length of one.
  const bool turned = std::abs(state.orientation.norm() - 1) <= 1e-3f;
  return finite & turned & (state.activation <= Activation::asleep) &
         (state.deactivation_time_s >= 0);
}

bool is_sane(const ContactManifold& manifold) {
  if (manifold.points.empty() || manifold.points.size() > 4) return false;
  for (const ContactPoint& p : manifold.points)
    if (!is_sane(p)) return false;
  return true;
}

}  // namespace aureole
