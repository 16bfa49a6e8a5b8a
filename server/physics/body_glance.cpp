// Passes over all bodies: by pointer, where asking for each by its id would search for it.
#include "server/base/check.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/physics_world.h"
#include "server/physics/physics_world_impl.h"

namespace aureole {

BodyId BodyGlance::id() const {
  return body_.id;
}
std::uint32_t BodyGlance::slot() const {
  return body_.slot;
}
PrototypeId BodyGlance::prototype() const {
  return body_.prototype;
}
bool BodyGlance::is_asleep() const {
  return !body_.rigid.isActive();
}
float BodyGlance::slow_for_s() const {
  return body_.rigid.getDeactivationTime();
}
WorldPosition BodyGlance::position() const {
  return world_.global(body_.rigid.getWorldTransform().getOrigin());
}
Eigen::Vector3f BodyGlance::linear_velocity() const {
  return from_bullet(body_.rigid.getLinearVelocity());
}
Eigen::Vector3f BodyGlance::angular_velocity() const {
  return from_bullet(body_.rigid.getAngularVelocity());
}
BodyState BodyGlance::state() const {
  return world_.state_of(body_);
}
Eigen::Vector3f BodyGlance::half_extents() const {
  btVector3 low, high;
  body_.rigid.getAabb(low, high);
  return from_bullet((high - low) / 2);
}

void PhysicsWorld::for_each(const std::function<void(const BodyGlance&)>& visit) const {
  for (const BulletBody* body : impl_->bodies.bodies) visit(BodyGlance(impl_->world, *body));
}

BodyGlance PhysicsWorld::awake_glance(std::size_t n) const {
  AUREOLE_CHECK(impl_->awake_is_current && n < impl_->awake.objects.size(),
                "awake() is asked before its members are looked at");
  return {impl_->world, *impl_->awake.objects[n]};
}
BodyGlance PhysicsWorld::glance(BodyId id) const {
  return {impl_->world, impl_->body(id)};
}

}  // namespace aureole
