// A rigid body as plain data: what stays (definition), what moves (state), what touches (contact).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "server/base/ids.h"
#include "server/base/world_position.h"
#include "server/physics/shape.h"

namespace aureole {

/// What never changes about a body. Shared by many bodies as a prototype.
struct BodyDefinition {
  Shape shape{SphereShape{0.5f}};
  float mass_kg = 1.0f;         ///< > 0
  float friction = 0.5f;        ///< ≥ 0
  float restitution = 0.0f;     ///< 0 … 1
  float linear_damping = 0.1f;  ///< 0 … 1, share of speed lost in a second
  float angular_damping = 0.5f;
  bool upright = false;  ///< Never rotates (avatars).
};

/// Immovable geometry.
struct StaticDefinition {
  Shape shape{PlaneShape{}};
  WorldPosition position;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  float friction = 0.5f;
  float restitution = 0.0f;
};

/// Bullet's activation states that a body of ours can be in.
enum class Activation : std::uint8_t {
  awake = 0,
  wants_sleep = 1,  ///< Slow for long enough; its island still has an awake member.
  asleep = 2,
};

/// Everything about a body that moves. Carrying it bit for bit carries the body.
struct BodyState {
  WorldPosition position;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  Eigen::Vector3f linear_velocity{0, 0, 0};   ///< m/s
  Eigen::Vector3f angular_velocity{0, 0, 0};  ///< rad/s
  Activation activation = Activation::awake;
  float deactivation_time_s = 0;  ///< How long it has been slow.
};

struct NewBody {
  BodyId id;
  PrototypeId prototype;
  BodyState state;
};

/// One side of a contact: a body, or a piece of static geometry.
using ContactPartner = std::variant<BodyId, StaticId>;

/// One contact point with the impulses that the solver had found for it (warm starting). Two bodies
/// that touch share up to four in each of their manifolds. Measured: without them a stack of ten
/// that changes its world moves by centimetres, with them by nothing.
struct ContactPoint {
  Eigen::Vector3f local_on_a{0, 0, 0};   ///< In a's frame (m).
  Eigen::Vector3f local_on_b{0, 0, 0};   ///< In b's frame (m).
  Eigen::Vector3f normal_on_b{0, 1, 0};  ///< World frame, from b to a.
  float distance = 0;                    ///< Negative: overlap (m).
  float impulse = 0;                     ///< Along the normal (N s).
  float impulse_lateral_1 = 0;
  float impulse_lateral_2 = 0;
  Eigen::Vector3f lateral_1{0, 0, 0};
  Eigen::Vector3f lateral_2{0, 0, 0};
  std::int32_t age_steps = 0;
  std::int32_t flags = 0;     ///< btManifoldPoint::m_contactPointFlags
  std::int16_t child_a = -1;  ///< Child of a compound shape, -1 for none.
  std::int16_t child_b = -1;
};

struct ContactManifold {
  BodyId a;
  ContactPartner b;
  std::uint16_t ordinal = 0;         ///< A compound pair has several manifolds, in this order.
  std::vector<ContactPoint> points;  ///< 1 … 4
};

/// What a body of this world presses on a stand-in with.
struct StandInLoad {
  BodyId stand_in;
  BodyId body;
  PrototypeId stand_in_prototype{}, body_prototype{};
  float impulse_ns = 0;  ///< Sum along the normals over all points of the last step (N s).
  friend bool operator==(const StandInLoad&, const StandInLoad&) = default;
};

}  // namespace aureole
