// What a step does to bodies one by one.
#pragma once

#include <btBulletDynamicsCommon.h>

namespace aureole {

/// Bullet's world, with the list of what moves opened up and memory asked for ahead of a walk.
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

}  // namespace aureole
