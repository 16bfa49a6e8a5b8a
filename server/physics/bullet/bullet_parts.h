// What a Bullet world is made of, where we have it do less work, or wait less for memory.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <vector>

#include "server/physics/bullet/bullet_body.h"
#include "server/physics/bullet/pair_order.h"

namespace aureole {

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
/// beforehand, and then there is nothing to scan for. A step walks through pairs in the order that
/// `m_deterministicOverlappingPairs` asks for; see PairOrder.
class PairCache : public btHashedOverlappingPairCache {
 public:
  void cleanProxyFromPairs(btBroadphaseProxy*, btDispatcher*) override {}
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy*, btDispatcher*) override {}

  using btHashedOverlappingPairCache::processAllOverlappingPairs;
  void processAllOverlappingPairs(btOverlapCallback* callback, btDispatcher*,
                                  const btDispatcherInfo&) override {
    order_.walk(getOverlappingPairArray(), *callback);
  }

 private:
  PairOrder order_;
};

/// Bullet's step, with two lists opened up and memory asked for ahead of walks.
class DynamicsWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  /// Bullet searches this list from its start for each removal. Ours is in the order of addresses:
  /// what a step does to each of them does not depend on the others.
  btAlignedObjectArray<btRigidBody*>& moving() { return m_nonStaticRigidBodies; }

  /// New boxes for whatever is awake, in Bullet's order.
  void updateAabbs() override;

 protected:
  /// Bullet damps sleepers too, and foretells where they will be. They stand still, and nobody
  /// reads it before they wake, and the next step foretells it.
  void predictUnconstraintMotion(btScalar dt_s) override;
};

/// Bullet's solver, which asks for contacts ahead of making rows of them.
class ContactSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count,
                       const btContactSolverInfo& info) override;
};

}  // namespace aureole
