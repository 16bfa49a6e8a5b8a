// Bodies become stand-ins and stand-ins bodies in place: Bullet's object, its box and its manifolds
// stay, so that a stack does not notice.
#include "server/physics/bullet/bullet_contacts.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/bullet_world.h"
#include "server/physics/bullet/group_proxies.h"
#include "server/physics/bullet/parts/address_order.h"

namespace aureole {
namespace {

bool is_fixed(const btCollisionObject* object) {
  const BulletBody* body = body_of(object);
  return !body || body->immovable() || body->marked;
}

}  // namespace

void BulletWorld::freeze(std::span<BulletBody* const> group) {
  for (BulletBody* body : group) body->marked = true;
  // Pairs of two that nothing moves must not exist: they would never be looked at again.
  const GroupProxies freezing(group);
  const btBroadphasePairArray& all = pairs_.getOverlappingPairArray();
  for (int i = 0; i < all.size();) {
    btBroadphaseProxy* const first = all[i].m_pProxy0;
    btBroadphaseProxy* const second = all[i].m_pProxy1;
    const bool concerned = freezing.hold(first) || freezing.hold(second);
    if (concerned && is_fixed(object_of(first)) && is_fixed(object_of(second)))
      pairs_.removeOverlappingPair(first, second, &dispatcher_);  // the last pair takes place i
    else
      ++i;
  }
  const Filter filter = filter_for(Mobility::fixed);
  for (BulletBody* body : group) {
    const BodyState state = state_of(*body);
    take_from_address_order(world_.moving(), &body->rigid);
    body->marked = false;
    body->role = Role::stand_in;
    body->rigid.clearForces();
    body->rigid.setMassProps(0, btVector3(0, 0, 0));
    body->rigid.setIslandTag(-1);
    btBroadphaseProxy* proxy = body->rigid.getBroadphaseHandle();
    proxy->m_collisionFilterGroup = filter.group;
    proxy->m_collisionFilterMask = filter.mask;
    put_state(*body, state);
  }
  // Their boxes are those of the last collision detection. Only now that all of the group are fixed
  // does a new box find no pair among them.
  for (BulletBody* body : group) world_.updateSingleAabb(&body->rigid);
}

void BulletWorld::thaw(BulletBody& stand_in, const BodyState& state) {
  btRigidBody& rigid = stand_in.rigid;
  const ShapeLibrary::Built& built = shapes_.prototype(stand_in.prototype);
  stand_in.role = Role::body;
  rigid.setMassProps(shapes_.prototypes()[stand_in.prototype.value].mass_kg, built.inertia);
  rigid.setGravity(aureole::to_bullet(settings_.gravity));
  put_state(stand_in, state);
  put_in_address_order(world_.moving(), &stand_in.rigid);
  const Filter filter = filter_for(Mobility::moving);
  btBroadphaseProxy* proxy = rigid.getBroadphaseHandle();
  proxy->m_collisionFilterGroup = filter.group;
  proxy->m_collisionFilterMask = filter.mask;
  // The ground and other stand-ins are new partners, found only when the box is put in anew.
  btVector3 low, high;
  rigid.getAabb(low, high);
  const btVector3 margin(gContactBreakingThreshold, gContactBreakingThreshold,
                         gContactBreakingThreshold);
  broadphase_.setAabbForceUpdate(proxy, low - margin, high + margin, &dispatcher_);
}

}  // namespace aureole
