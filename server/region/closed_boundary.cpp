// Keeping bodies out of areas where nobody simulates.
#include "server/region/closed_boundary.h"

#include <cmath>

namespace aureole {
namespace {

/// What neighbours and friction can add to a body's way in one step (m).
constexpr double push_m = 0.5;

bool is_beside_x(const Rectangle& area, const WorldPosition& at) {
  return at.x < area.min_x || at.x >= area.max_x;
}

/// The nearest place on the far side of an edge. The lower edge belongs to the area; a millimetre
/// is more than the physics' floats lose.
double outside_of(double min, double max, double at) {
  return at - min < max - at ? min - 0.001 : max;
}

}  // namespace

void ClosedBoundary::before_step(PhysicsWorld& physics, float dt_s) {
  if (closed_.empty()) return;
  for (BodyId id : physics.ids()) {
    if (physics.is_asleep(id)) continue;
    const BodyState state = physics.state(id);
    const WorldPosition& at = state.position;
    Eigen::Vector3f velocity = state.linear_velocity;
    const double reach_m = static_cast<double>(velocity.norm() * dt_s) + push_m;
    for (std::size_t i = 0; i < closed_.size(); ++i) {
      const Rectangle& area = closed_[i];
      if (area.contains(at.x, at.z) || area.distance(at.x, at.z) > reach_m) continue;
      outside_.push_back({id, i});
      const double next_x = at.x + static_cast<double>(velocity.x() * dt_s);
      const double next_z = at.z + static_cast<double>(velocity.z() * dt_s);
      if (!area.contains(next_x, next_z)) continue;
      // It comes in across an edge of x, of z, or of both over a corner.
      if (is_beside_x(area, at)) velocity.x() = 0;
      if (at.z < area.min_z || at.z >= area.max_z) velocity.z() = 0;
    }
    if (velocity != state.linear_velocity)
      physics.set_velocity(id, velocity, Eigen::Vector3f::Zero());
  }
}

void ClosedBoundary::after_step(PhysicsWorld& physics) const {
  for (const auto& [id, i] : outside_) {
    BodyState state = physics.state(id);
    WorldPosition& at = state.position;
    const Rectangle& area = closed_[i];
    if (!area.contains(at.x, at.z)) continue;
    // Back over the nearer edge: steps are short, so that is the one it came across.
    const double x = outside_of(area.min_x, area.max_x, at.x);
    const double z = outside_of(area.min_z, area.max_z, at.z);
    if (std::abs(x - at.x) <= std::abs(z - at.z)) {
      at.x = x;
      state.linear_velocity.x() = 0;
    } else {
      at.z = z;
      state.linear_velocity.z() = 0;
    }
    state.angular_velocity.setZero();
    physics.set_state(id, state);
  }
}

}  // namespace aureole
