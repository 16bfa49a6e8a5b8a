// Questions to a Bullet world: who is near, who touches, what a ray meets.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "server/physics/bullet/bullet_world.h"

namespace aureole {

/// Calls `visit` for every pair of `body` that may hold contacts, found through the broadphase: a
/// few microseconds, however many bodies there are. In no particular order.
void for_each_pair(BulletWorld& world, const BulletBody& body,
                   const std::function<void(btCollisionObject&, const btBroadphasePair&)>& visit);

std::vector<BodyId> bodies_touching(BulletWorld& world, const BulletBody& body);
/// What one pass over all contacts finds.
struct ContactSurvey {
  /// Who touches whom, bodies by their slots and stand-ins as outsiders; a compound pair may be
  /// named more than once.
  std::vector<ContactGraph::Edge> edges;
  std::vector<StandInLoad> loads;  ///< See PhysicsWorld::stand_in_loads.
};
/// Replaces what is in `survey`.
void survey_contacts(BulletWorld& world, ContactSurvey& survey);
bool has_support(BulletWorld& world, const BulletBody& body, float min_up);
std::vector<BodyId> bodies_in_sphere(BulletWorld& world, const WorldPosition& centre, float radius);
std::optional<RayHit> nearest_hit(BulletWorld& world, const WorldPosition& from,
                                  const WorldPosition& to, const BulletBody* ignore);

}  // namespace aureole
