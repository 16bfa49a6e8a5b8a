// Who is in the Bullet world: bodies come with their boxes, leave with their pairs, are moved by
// hand.
#include <LinearMath/btAabbUtil2.h>

#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/bullet/bullet_world.h"
#include "server/physics/bullet/group_proxies.h"
#include "server/physics/bullet/parts/address_order.h"
#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// Bullet's boxes are this much wider than the bodies, so that contacts exist before they overlap.
btVector3 contact_margin() {
  return {gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold};
}

}  // namespace

bool has_contact_points(const btBroadphasePair& pair, btManifoldArray& scratch) {
  if (!pair.m_algorithm) return false;
  scratch.resize(0);
  pair.m_algorithm->getAllContactManifolds(scratch);
  for (int i = 0; i < scratch.size(); ++i)
    if (scratch[i]->getNumContacts() > 0) return true;
  return false;
}

BulletWorld::Filter BulletWorld::filter_for(Mobility mobility) {
  // What nothing moves need not be tested against its like.
  if (mobility == Mobility::moving)
    return {btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter};
  return {btBroadphaseProxy::StaticFilter,
          btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter};
}

void BulletWorld::insert_object(btCollisionObject& object, Mobility mobility) {
  const Filter filter = filter_for(mobility);
  btCollisionObjectArray& objects = world_.getCollisionObjectArray();
  object.setWorldArrayIndex(objects.size());
  objects.push_back(&object);
  // With its margin at once: a sleeping body's box is not looked at again, and two that rest on
  // each other need not overlap by themselves.
  btVector3 low, high;
  object.getCollisionShape()->getAabb(object.getWorldTransform(), low, high);
  object.setBroadphaseHandle(broadphase_.createProxy(
      low - contact_margin(), high + contact_margin(), object.getCollisionShape()->getShapeType(),
      &object, filter.group, filter.mask, &dispatcher_));
}

void BulletWorld::insert(BulletBody& body) {
  if (body.role == Role::obstacle) world_.kinematic().push_back(&body.rigid);
  if (!body.immovable()) put_in_address_order(world_.moving(), &body.rigid);
  insert_object(body.rigid, body.immovable() ? Mobility::fixed : Mobility::moving);
}

void BulletWorld::take_out(BulletBody& body) {
  if (body.role == Role::obstacle) std::erase(world_.kinematic(), &body.rigid);
  if (!body.immovable()) take_from_address_order(world_.moving(), &body.rigid);
  world_.btCollisionWorld::removeCollisionObject(&body.rigid);
  body.marked = false;
}

void BulletWorld::erase(std::span<BulletBody* const> group, Wake wake) {
  for (BulletBody* body : group) body->marked = true;
  const GroupProxies leaving(group);
  btManifoldArray scratch;
  btBroadphasePairArray& all = pairs_.getOverlappingPairArray();
  for (int i = 0; i < all.size();) {
    const btBroadphasePair& pair = all[i];
    btBroadphaseProxy* const first = pair.m_pProxy0;
    btBroadphaseProxy* const second = pair.m_pProxy1;
    const bool first_leaves = leaving.hold(first);
    const bool second_leaves = leaving.hold(second);
    if (!first_leaves && !second_leaves) {
      ++i;
      continue;
    }
    BulletBody* stays = body_of(object_of(first_leaves ? second : first));
    // Two that arrived asleep have never been looked at: overlapping boxes count as touching.
    if (wake == Wake::touching && stays && !stays->marked && !stays->immovable() &&
        (has_contact_points(pair, scratch) ||
         (!pair.m_algorithm && TestAabbAgainstAabb2(first->m_aabbMin, first->m_aabbMax,
                                                    second->m_aabbMin, second->m_aabbMax))))
      stays->rigid.activate(true);
    pairs_.removeOverlappingPair(first, second, &dispatcher_);  // the last pair takes place i
  }
  for (BulletBody* body : group) take_out(*body);
}

void BulletWorld::erase_all(std::span<BulletBody* const> all) {
  btBroadphasePairArray& pairs = pairs_.getOverlappingPairArray();
  while (pairs.size() > 0) {
    const btBroadphasePair& last = pairs[pairs.size() - 1];
    pairs_.removeOverlappingPair(last.m_pProxy0, last.m_pProxy1, &dispatcher_);
  }
  for (BulletBody* body : all) take_out(*body);
}

void BulletWorld::moved_by_hand(BulletBody& body, Wake wake) {
  for (const ContactEdge& edge : body.contact_edges) prefetch_manifold(edge.manifold);
  for (const auto& [manifold, other] : body.contact_edges) {
    if (manifold->getNumContacts() == 0) continue;
    if (wake == Wake::touching && other && !other->immovable()) other->rigid.activate(true);
    // Points that no longer hold would carry a sleeping body for ever.
    manifold->refreshContactPoints(manifold->getBody0()->getWorldTransform(),
                                   manifold->getBody1()->getWorldTransform());
  }
  world_.updateSingleAabb(&body.rigid);
}

}  // namespace aureole
