// Which body is in the crosshair: a ray against the shapes of the bodies as they are drawn.
#pragma once

#include <optional>
#include <span>

#include "server/gateway/web/browser_messages.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole {

/// How far a player reaches from the eye (unit: m), and how much one can lift (unit: kg).
inline constexpr float grab_reach_m = 4.5f;
inline constexpr float grab_mass_max_kg = 60.0f;
/// The eye is this far below the top of the avatar's capsule (unit: m).
inline constexpr double eye_below_top_m = 0.2;

/// Unit vector that a player looks along.
Eigen::Vector3f look_direction(Look look);

/// Distance along the ray (unit direction, the shape's frame) to the shape's surface, 0 if the ray
/// starts inside, nothing if it misses. Convex hulls count as the box around their points.
std::optional<float> ray_hits(const Shape& shape, const Eigen::Vector3f& from,
                              const Eigen::Vector3f& direction);

struct GrabRay {
  WorldPosition eye;
  Look look;
};

/// The nearest thing along the ray within reach, if it is a body that a player can carry: no
/// avatar, at most grab_mass_max_kg, and not behind static geometry or something heavier. `poses`
/// may come in any order.
std::optional<BodyId> pick_body(const WorldDefinition& world, std::span<const ReplicaPose> poses,
                                const GrabRay& ray);

}  // namespace aureole
