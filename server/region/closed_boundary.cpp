// Taking the velocity that leads into an area where nobody simulates.
#include "server/region/closed_boundary.h"

namespace aureole {
namespace {

/// The velocity without what leads into `area`; the same if it does not lead there in dt_s.
Eigen::Vector3f held_back(const Rectangle& area, const WorldPosition& at,
                          const Eigen::Vector3f& velocity, float dt_s) {
  if (area.contains(at.x, at.z)) return velocity;
  const double next_x = at.x + static_cast<double>(velocity.x()) * dt_s;
  const double next_z = at.z + static_cast<double>(velocity.z()) * dt_s;
  if (!area.contains(next_x, next_z)) return velocity;
  Eigen::Vector3f held = velocity;
  // It comes in across an edge of x, of z, or of both over a corner.
  if (at.x < area.min_x || at.x >= area.max_x) held.x() = 0;
  if (at.z < area.min_z || at.z >= area.max_z) held.z() = 0;
  return held;
}

}  // namespace

void hold_back(PhysicsWorld& physics, const PartitionMap& map, std::span<const RegionId> closed,
               float dt_s) {
  if (closed.empty()) return;
  for (BodyId id : physics.ids()) {
    if (physics.is_asleep(id)) continue;
    const BodyState state = physics.state(id);
    Eigen::Vector3f velocity = state.linear_velocity;
    for (RegionId region : closed)
      velocity = held_back(map.area(region), state.position, velocity, dt_s);
    if (velocity != state.linear_velocity)
      physics.set_velocity(id, velocity, state.angular_velocity);
  }
}

}  // namespace aureole
