// Bullet's world with the measured settings, and bodies that come and go as groups.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "server/physics/body.h"
#include "server/physics/bullet/bullet_shapes.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// What a Bullet body is to us.
enum class Role : std::uint8_t {
  body,      ///< Moves as physics has it.
  obstacle,  ///< Moves along its own velocity and nothing stops it.
  stand_in,  ///< Never moves.
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
  std::vector<btPersistentManifold*> manifolds;
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

class BulletWorld;

/// Bodies that are awake, as they are, and where they are.
struct AwakeBodies {
  std::vector<NewBody> bodies;
  std::vector<const BulletBody*> objects;
  void clear() {
    bodies.clear();
    objects.clear();
  }
  void note(const BulletWorld& world, const BulletBody& body);
};

/// Bullet refuses pairs of sleeping bodies, and their algorithms then never get a manifold. While
/// carried contacts are installed, every pair counts.
///
/// Bullet lists manifolds by world only. To find those of a few bodies without walking through all,
/// each is noted at its bodies from its making to its release.
class Dispatcher : public btCollisionDispatcher {
 public:
  using btCollisionDispatcher::btCollisionDispatcher;
  bool needsCollision(const btCollisionObject* a, const btCollisionObject* b) override {
    return admit_sleeping_ || btCollisionDispatcher::needsCollision(a, b);
  }
  void admit_sleeping(bool admit) { admit_sleeping_ = admit; }

  btPersistentManifold* getNewManifold(const btCollisionObject* a,
                                       const btCollisionObject* b) override {
    btPersistentManifold* manifold = btCollisionDispatcher::getNewManifold(a, b);
    for (const btCollisionObject* object : {a, b})
      if (BulletBody* body = body_of(object)) body->manifolds.push_back(manifold);
    return manifold;
  }
  void releaseManifold(btPersistentManifold* manifold) override {
    for (const btCollisionObject* object : {manifold->getBody0(), manifold->getBody1()})
      if (BulletBody* body = body_of(object)) std::erase(body->manifolds, manifold);
    btCollisionDispatcher::releaseManifold(manifold);
  }

 private:
  bool admit_sleeping_ = false;
};

/// Bullet scans all pairs twice for each removed body. A group's pairs are taken out in one pass
/// beforehand, and then there is nothing to scan for.
class PairCache : public btHashedOverlappingPairCache {
 public:
  void cleanProxyFromPairs(btBroadphaseProxy*, btDispatcher*) override {}
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy*, btDispatcher*) override {}
};

/// Opens up the list of moving bodies, which Bullet searches from the start for each removal. Ours
/// is in the order of addresses: what a step does to each of them does not depend on the others.
class DynamicsWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  btAlignedObjectArray<btRigidBody*>& moving() { return m_nonStaticRigidBodies; }

 protected:
  /// Bullet damps sleepers too, and foretells where they will be. They stand still, and nobody
  /// reads it before they wake, and the next step foretells it.
  void predictUnconstraintMotion(btScalar dt_s) override {
    for (int i = 0; i < m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *m_nonStaticRigidBodies[i];
      if (!body.isActive() || body.isStaticOrKinematicObject()) continue;
      body.applyDamping(dt_s);
      body.predictIntegratedTransform(dt_s, body.getInterpolationWorldTransform());
    }
  }
};

/// Owns the Bullet objects of one world except the bodies' memory.
class BulletWorld {
 public:
  BulletWorld(const PhysicsSettings& settings, ShapeLibrary& shapes, std::size_t expected_bodies);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// A body that is not in the world yet, in `state` exactly.
  std::unique_ptr<BulletBody> make_body(const NewBody& body, Role role);
  /// Puts `state` into a body, bit for bit; no one else is told.
  void put_state(BulletBody& body, const BodyState& state) const;
  BodyState state_of(const BulletBody& body) const;

  void insert(BulletBody& body);
  /// Takes bodies out with their pairs in one pass.
  void erase(std::span<BulletBody* const> group, Wake wake);
  /// Takes all bodies out and wakes nobody.
  void erase_all(std::span<BulletBody* const> all);
  /// Bodies become stand-ins where they are and keep their contacts with those that stay bodies.
  void freeze(std::span<BulletBody* const> group);
  /// A stand-in becomes a body in `state` and keeps its contacts; nobody is woken.
  void thaw(BulletBody& stand_in, const BodyState& state);
  /// After a body was moved by hand: its box, its pairs, and who was touching it.
  void moved_by_hand(BulletBody& body, Wake wake);

  /// `all` are the world's bodies, in any order that is the same each time. Replaces `awake` by
  /// those that are awake after the step, in that order: here their memory is at hand anyway.
  void step(float dt_s, std::span<BulletBody* const> all, AwakeBodies& awake);

  btVector3 local(const WorldPosition& p) const;
  WorldPosition global(const btVector3& p) const;

  const PhysicsSettings& settings() const { return settings_; }
  ShapeLibrary& shapes() const { return shapes_; }
  DynamicsWorld& dynamics() { return world_; }
  const DynamicsWorld& dynamics() const { return world_; }
  Dispatcher& dispatcher() { return dispatcher_; }
  const Dispatcher& dispatcher() const { return dispatcher_; }
  PairCache& pairs() { return pairs_; }
  btDbvtBroadphase& broadphase() { return broadphase_; }
  std::span<const std::unique_ptr<btCollisionObject>> statics() const { return statics_; }

 private:
  void add_statics();
  enum class Mobility { moving, fixed };
  struct Filter {
    int group;
    int mask;
  };
  static Filter filter_for(Mobility mobility);
  void insert_object(btCollisionObject& object, Mobility mobility);
  void take_out(BulletBody& body);
  void drive_obstacles(float dt_s);
  static void before_solving(btDynamicsWorld* world, btScalar dt_s);

  PhysicsSettings settings_;
  ShapeLibrary& shapes_;
  btDefaultCollisionConfiguration configuration_;
  Dispatcher dispatcher_;
  PairCache pairs_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  DynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionObject>> statics_;
  std::vector<BulletBody*> obstacles_;
};

/// True if at least one contact point joins the two bodies of `pair`.
bool has_contact_points(const btBroadphasePair& pair, btManifoldArray& scratch);

}  // namespace aureole
