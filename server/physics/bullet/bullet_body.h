// A body as Bullet has it, and the way from Bullet's objects back to ours.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "server/base/ids.h"
#include "server/physics/body.h"

namespace aureole {

/// What a Bullet body is to us.
enum class Role : std::uint8_t {
  body,      ///< Moves as physics has it.
  obstacle,  ///< Moves along its own velocity and nothing stops it.
  stand_in,  ///< Never moves.
};

struct BulletBody;

/// One of a body's manifolds, and who else it is of.
struct ContactEdge {
  btPersistentManifold* manifold;
  BulletBody* partner;  ///< A body or a stand-in; null: static geometry.
};

/// A body as Bullet has it, and what Bullet cannot keep exactly.
struct BulletBody {
  BulletBody(BodyId body_id, PrototypeId body_prototype,
             const btRigidBody::btRigidBodyConstructionInfo& info)
      : id(body_id), prototype(body_prototype), rigid(info) {}

  BodyId id;
  PrototypeId prototype;
  Role role = Role::body;
  bool upright = false;
  bool marked = false;     ///< Member of the group that a call is about; false between calls.
  std::uint32_t slot = 0;  ///< See BodyGlance::slot(); stand-ins have one too.
  /// Bullet's for its pairs, with points or without; in no order. See Dispatcher.
  std::vector<ContactEdge> contact_edges;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};  ///< What the basis was made of.
  Eigen::Vector3f obstacle_linear{0, 0, 0};                        ///< m/s
  Eigen::Vector3f obstacle_angular{0, 0, 0};                       ///< rad/s
  btRigidBody rigid;

  /// Nothing pushes it: without mass to the solver, and nobody wakes it.
  bool immovable() const { return role != Role::body; }
};

/// The body behind a Bullet object; null for static geometry.
inline BulletBody* body_of(const btCollisionObject* object) {
  return static_cast<BulletBody*>(object->getUserPointer());
}
/// The static behind a Bullet object that is no body.
inline StaticId static_of(const btCollisionObject* object) {
  return StaticId{static_cast<StaticId::rep>(object->getUserIndex())};
}
inline btCollisionObject* object_of(const btBroadphaseProxy* proxy) {
  return static_cast<btCollisionObject*>(proxy->m_clientObject);
}

}  // namespace aureole
