// Walks over what is awake, with memory asked for ahead.
#include "server/physics/bullet/parts/dynamics_world.h"

#include <bit>
#include <cstddef>

#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// How many objects lie between asking for something and reading it, …
constexpr std::size_t ahead = 4;
/// … and where all that is done is to see that one sleeps.
constexpr int far_ahead = 16;

}  // namespace

void DynamicsWorld::find_awake(std::vector<btRigidBody*>& awake) {
  awake.clear();
  const int count = m_nonStaticRigidBodies.size();
  for (int n = 0; n < count; ++n) {
    if (n + far_ahead < count) prefetch_activation(m_nonStaticRigidBodies[n + far_ahead]);
    if (m_nonStaticRigidBodies[n]->isActive()) awake.push_back(m_nonStaticRigidBodies[n]);
  }
}

void DynamicsWorld::saveKinematicState(btScalar dt_s) {
  for (btRigidBody* body : kinematic_)
    if (body->getActivationState() != ISLAND_SLEEPING) body->saveKinematicState(dt_s);
}

void DynamicsWorld::applyGravity() {
  find_awake(awake_);
  steps_ = true;
  for (std::size_t n = 0; n < awake_.size(); ++n) {
    if (const std::size_t m = n + ahead; m < awake_.size())
      prefetch(awake_[m], sizeof(btRigidBody));
    awake_[n]->applyGravity();
  }
}

void DynamicsWorld::predictUnconstraintMotion(btScalar dt_s) {
  const std::size_t count = awake_.size();
  const auto proxy = [&](std::size_t n) {
    return static_cast<const btDbvtProxy*>(awake_[n]->getBroadphaseHandle());
  };
  for (std::size_t n = 0; n < count; ++n) {
    btRigidBody* const body = awake_[n];
    // For updateAabbs(), which waits for memory, while there is much to compute here.
    if (n + 3 * ahead < count) prefetch(proxy(n + 3 * ahead), sizeof(btDbvtProxy));
    if (n + ahead < count) prefetch(proxy(n + ahead)->leaf);
    if (body->isStaticOrKinematicObject()) continue;
    body->applyDamping(dt_s);
    body->predictIntegratedTransform(dt_s, body->getInterpolationWorldTransform());
  }
}

/// In Bullet's order, which is that of the world's list of objects: pairs come in it.
void DynamicsWorld::updateAabbs() {
  if (!steps_ || m_forceUpdateAllAabbs) return btDiscreteDynamicsWorld::updateAabbs();
  constexpr int word_bits = 64;
  renewed_.assign(static_cast<std::size_t>(m_collisionObjects.size() / word_bits + 1), 0);
  const auto renew = [&](const btRigidBody* body) {
    const int at = body->getWorldArrayIndex();
    renewed_[static_cast<std::size_t>(at / word_bits)] |= std::uint64_t{1} << at % word_bits;
  };
  for (const btRigidBody* body : awake_) renew(body);
  for (const btRigidBody* body : kinematic_)
    if (body->isActive()) renew(body);
  order_.clear();
  for (std::size_t word = 0; word < renewed_.size(); ++word)
    for (std::uint64_t rest = renewed_[word]; rest != 0; rest &= rest - 1)
      order_.push_back(static_cast<int>(word) * word_bits + std::countr_zero(rest));

  const std::size_t count = order_.size();
  const auto object = [&](std::size_t n) { return m_collisionObjects[order_[n]]; };
  const auto proxy = [&](std::size_t n) {
    return static_cast<const btDbvtProxy*>(object(n)->getBroadphaseHandle());
  };
  for (std::size_t n = 0; n < count; ++n) {
    // Each thing is found through the one that has been asked for before it.
    if (n + 3 * ahead < count) prefetch_object(object(n + 3 * ahead));
    if (n + 2 * ahead < count) prefetch(proxy(n + 2 * ahead), sizeof(btDbvtProxy));
    if (n + ahead < count) prefetch(proxy(n + ahead)->leaf);
    updateSingleAabb(object(n));
  }
}

void DynamicsWorld::integrateTransforms(btScalar dt_s) {
  find_awake(awake_now_);
  for (std::size_t n = 0; n < awake_now_.size(); ++n) {
    if (const std::size_t m = n + ahead; m < awake_now_.size())
      prefetch(awake_now_[m], sizeof(btRigidBody));
    integrateTransformsInternal(&awake_now_[n], 1, dt_s);
  }
}

/// Bullet asks for it after a step of no time too, which has not found anybody.
void DynamicsWorld::clearForces() {
  if (!steps_) return btDiscreteDynamicsWorld::clearForces();
  for (btRigidBody* body : awake_) body->clearForces();
  steps_ = false;
}

}  // namespace aureole
