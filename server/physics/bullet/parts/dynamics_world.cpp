// Walks over bodies, with memory asked for ahead.
#include "server/physics/bullet/parts/dynamics_world.h"

#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// How many objects lie between asking for something and reading it.
constexpr int ahead = 4;

}  // namespace

void DynamicsWorld::updateAabbs() {
  const int count = m_collisionObjects.size();
  const auto proxy = [&](int n) {
    return static_cast<const btDbvtProxy*>(m_collisionObjects[n]->getBroadphaseHandle());
  };
  for (int n = 0; n < count; ++n) {
    // Each thing is found through the one that has been asked for before it.
    if (const int m = n + 3 * ahead; m < count) prefetch_activation(m_collisionObjects[m]);
    if (const int m = n + 2 * ahead; m < count && m_collisionObjects[m]->isActive()) {
      prefetch_object(m_collisionObjects[m]);
      prefetch(proxy(m), sizeof(btDbvtProxy));
    }
    if (const int m = n + ahead; m < count && m_collisionObjects[m]->isActive())
      prefetch(proxy(m)->leaf);
    if (m_forceUpdateAllAabbs || m_collisionObjects[n]->isActive())
      updateSingleAabb(m_collisionObjects[n]);
  }
}

void DynamicsWorld::predictUnconstraintMotion(btScalar dt_s) {
  for (int n = 0; n < m_nonStaticRigidBodies.size(); ++n) {
    btRigidBody& body = *m_nonStaticRigidBodies[n];
    if (!body.isActive() || body.isStaticOrKinematicObject()) continue;
    body.applyDamping(dt_s);
    body.predictIntegratedTransform(dt_s, body.getInterpolationWorldTransform());
  }
}

}  // namespace aureole
