// Bullet's world with the measured settings, and bodies that come and go as groups.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "server/physics/body.h"
#include "server/physics/bullet/bullet_body.h"
#include "server/physics/bullet/bullet_shapes.h"
#include "server/physics/bullet/parts/contact_solver.h"
#include "server/physics/bullet/parts/dispatcher.h"
#include "server/physics/bullet/parts/dynamics_world.h"
#include "server/physics/bullet/parts/pair_cache.h"
#include "server/physics/physics_world.h"

namespace aureole {

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
  void read(const BulletBody& body, BodyState& state) const;

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
  ContactSolver solver_;
  DynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionObject>> statics_;
};

/// True if at least one contact point joins the two bodies of `pair`.
bool has_contact_points(const btBroadphasePair& pair, btManifoldArray& scratch);

}  // namespace aureole
