// Questions to a Bullet world: who is near, who touches, what a ray meets.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "server/base/prefetch.h"
#include "server/physics/bullet/bullet_world.h"

namespace aureole {

/// Calls `visit` for every pair of `body` that may hold contacts, found through the broadphase: a
/// few microseconds, however many bodies there are. In no particular order.
void for_each_pair(BulletWorld& world, const BulletBody& body,
                   const std::function<void(btCollisionObject&, const btBroadphasePair&)>& visit);

std::vector<BodyId> bodies_touching(BulletWorld& world, const BulletBody& body);
/// Replaces `found` by the slots of the bodies that share a contact point with `body`, ascending.
/// Returns how many it touches, stand-ins included; a compound stand-in may count more than once.
std::size_t find_touching(const BulletBody& body, std::vector<std::uint32_t>& found);
/// Begins to bring nearer what that needs.
void fetch_touching(const BulletBody& body, FetchStep step);
/// Appends what awake bodies press on a stand-in with, ascending by their ids.
void append_loads(const BulletBody& stand_in, std::vector<StandInLoad>& loads);
bool has_support(BulletWorld& world, const BulletBody& body, float min_up);
std::vector<BodyId> bodies_in_sphere(BulletWorld& world, const WorldPosition& centre, float radius);
std::optional<RayHit> nearest_hit(BulletWorld& world, const WorldPosition& from,
                                  const WorldPosition& to, const BulletBody* ignore);

}  // namespace aureole
