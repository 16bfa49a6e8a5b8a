// Who is looked at for contacts, and contacts found from their bodies.
#pragma once

#include <btBulletCollisionCommon.h>

#include <vector>

#include "server/physics/bullet/bullet_body.h"

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
    BulletBody *first = body_of(a), *second = body_of(b);
    if (first) first->contact_edges.push_back({manifold, second});
    if (second) second->contact_edges.push_back({manifold, first});
    return manifold;
  }
  void releaseManifold(btPersistentManifold* manifold) override {
    for (const btCollisionObject* object : {manifold->getBody0(), manifold->getBody1()})
      if (BulletBody* body = body_of(object))
        std::erase_if(body->contact_edges,
                      [&](const ContactEdge& edge) { return edge.manifold == manifold; });
    btCollisionDispatcher::releaseManifold(manifold);
  }

 private:
  bool admit_sleeping_ = false;
};

}  // namespace aureole
