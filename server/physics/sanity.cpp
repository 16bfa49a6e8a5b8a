// What a state or a contact must fulfil before Bullet may see it, whoever sent it.
#include <cmath>

#include "server/physics/physics_world.h"

namespace aureole {
namespace {

bool in_range(std::int16_t child) {
  return child >= -1;
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
  return state.position.is_finite() && state.orientation.coeffs().allFinite() &&
         std::abs(state.orientation.norm() - 1) <= 1e-3f && state.linear_velocity.allFinite() &&
         state.angular_velocity.allFinite() && state.activation <= Activation::asleep &&
         std::isfinite(state.deactivation_time_s) && state.deactivation_time_s >= 0;
}

bool is_sane(const ContactManifold& manifold) {
  if (manifold.points.empty() || manifold.points.size() > 4) return false;
  for (const ContactPoint& p : manifold.points)
    if (!is_sane(p)) return false;
  return true;
}

}  // namespace aureole
