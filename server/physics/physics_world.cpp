// Bodies by id on top of the Bullet world: the plain-data surface of this room.
#include "server/physics/physics_world.h"

#include <algorithm>
#include <utility>

#include "server/base/check.h"
#include "server/base/hash.h"
#include "server/physics/bullet/bullet_contacts.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/physics_world_impl.h"

namespace aureole {

PhysicsWorld::PhysicsWorld(const PhysicsSettings& settings,
                           std::span<const BodyDefinition> prototypes,
                           std::span<const StaticDefinition> statics, std::size_t expected_bodies) {
  auto shapes = std::make_unique<ShapeLibrary>(prototypes, statics);
  ShapeLibrary& library = *shapes;
  impl_ = std::make_unique<Impl>(settings, std::move(shapes), library, expected_bodies);
}

PhysicsWorld::PhysicsWorld(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PhysicsWorld::~PhysicsWorld() = default;
PhysicsWorld::PhysicsWorld(PhysicsWorld&&) noexcept = default;
PhysicsWorld& PhysicsWorld::operator=(PhysicsWorld&&) noexcept = default;

PhysicsWorld PhysicsWorld::scratch(std::size_t expected_bodies) const {
  return PhysicsWorld(std::make_unique<Impl>(impl_->world.settings(), nullptr,
                                             impl_->world.shapes(), expected_bodies));
}

void PhysicsWorld::add_obstacle(const NewBody& body) {
  BulletBody* const obstacle = impl_->create(body, Role::obstacle);
  impl_->bodies.merge({&obstacle, 1});
  impl_->changed();
}

void PhysicsWorld::remove(std::span<const BodyId> ids, Wake wake) {
  impl_->destroy(impl_->bodies, impl_->group_of(ids, &Impl::body), wake);
}

void PhysicsWorld::install_contacts(std::span<const ContactManifold> contacts) {
  const auto object_for = [&](const ContactPartner& partner) -> btCollisionObject* {
    if (const BodyId* id = std::get_if<BodyId>(&partner)) {
      BulletBody* found = impl_->find(*id);
      return found ? &found->rigid : nullptr;
    }
    const auto statics = impl_->world.statics();
    const std::size_t index = std::get<StaticId>(partner).value;
    return index < statics.size() ? statics[index].get() : nullptr;
  };
  std::vector<CarriedContact> carried;
  carried.reserve(contacts.size());
  for (const ContactManifold& manifold : contacts)
    carried.push_back({object_for(manifold.a), object_for(manifold.b), &manifold});
  aureole::install_contacts(impl_->world, std::move(carried));
  impl_->changed();
}

std::vector<ContactManifold> PhysicsWorld::contacts_within(std::span<const BodyId> group) const {
  return extract_contacts(impl_->world, impl_->group_of(group, &Impl::body), Partners::within);
}

std::vector<ContactManifold> PhysicsWorld::contacts_around(
    std::span<const BodyId> group, std::vector<BodyId>* beside_others) const {
  return extract_contacts(impl_->world, impl_->group_of(group, &Impl::body_or_stand_in),
                          Partners::all, beside_others);
}

std::vector<BodyId> PhysicsWorld::touching(BodyId id) const {
  return bodies_touching(impl_->world, impl_->body_or_stand_in(id));
}

std::size_t PhysicsWorld::find_touching(std::uint32_t slot,
                                        std::vector<std::uint32_t>& found) const {
  return aureole::find_touching(*impl_->by_slot[slot], found);
}

void PhysicsWorld::fetch_touching(std::uint32_t slot, FetchStep step) const {
  aureole::fetch_touching(*impl_->by_slot[slot], step);
}

std::size_t PhysicsWorld::slots() const {
  return impl_->by_slot.size();
}

BodyId PhysicsWorld::body_in_slot(std::uint32_t slot) const {
  return impl_->by_slot[slot]->id;
}

bool PhysicsWorld::is_supported(BodyId id, float min_up) const {
  return has_support(impl_->world, impl_->body(id), min_up);
}

void PhysicsWorld::step(float dt_s) {
  AUREOLE_CHECK(dt_s > 0, "a step takes time");
  impl_->world.step(dt_s, impl_->bodies.bodies, impl_->awake);
  impl_->changed();
  impl_->awake_is_current = true;
}

bool PhysicsWorld::contains(BodyId id) const {
  const BulletBody* found = impl_->find(id);
  return found && found->role != Role::stand_in;
}
std::size_t PhysicsWorld::size() const {
  return impl_->bodies.ids.size();
}

std::size_t PhysicsWorld::awake_count() const {
  if (impl_->awake_is_current) return impl_->awake.bodies.size();
  if (!impl_->awake_count)
    impl_->awake_count = static_cast<std::size_t>(
        std::count_if(impl_->bodies.bodies.begin(), impl_->bodies.bodies.end(),
                      [](const BulletBody* body) { return body->rigid.isActive(); }));
  return *impl_->awake_count;
}

std::span<const NewBody> PhysicsWorld::awake() const {
  if (!impl_->awake_is_current) {
    impl_->awake.clear();
    for (BulletBody* body : impl_->bodies.bodies)
      if (body->rigid.isActive()) impl_->awake.note(impl_->world, *body);
    impl_->awake_is_current = true;
  }
  return impl_->awake.bodies;
}

std::span<const BodyId> PhysicsWorld::ids() const {
  return impl_->bodies.ids;
}
PrototypeId PhysicsWorld::prototype(BodyId id) const {
  return impl_->body(id).prototype;
}
BodyState PhysicsWorld::state(BodyId id) const {
  return impl_->world.state_of(impl_->body(id));
}

WorldPosition PhysicsWorld::position(BodyId id) const {
  return impl_->world.global(impl_->body(id).rigid.getWorldTransform().getOrigin());
}

Eigen::Vector3f PhysicsWorld::half_extents(BodyId id) const {
  btVector3 low, high;
  impl_->body(id).rigid.getAabb(low, high);
  return from_bullet((high - low) / 2);
}

bool PhysicsWorld::is_asleep(BodyId id) const {
  return !impl_->body(id).rigid.isActive();
}

void PhysicsWorld::set_state(BodyId id, const BodyState& state) {
  BulletBody& body = impl_->body(id);
  const BodyState before = impl_->world.state_of(body);
  impl_->world.put_state(body, state);
  if (before.position != state.position ||
      before.orientation.coeffs() != state.orientation.coeffs())
    impl_->world.moved_by_hand(body, Wake::touching);
  impl_->changed();
}

void PhysicsWorld::apply_impulse(BodyId id, const Eigen::Vector3f& impulse) {
  AUREOLE_CHECK(impulse.allFinite(), "an impulse is finite");
  impl_->body(id).rigid.applyCentralImpulse(to_bullet(impulse));
  wake(id);
}

void PhysicsWorld::set_velocity(BodyId id, const Eigen::Vector3f& linear,
                                const Eigen::Vector3f& angular) {
  AUREOLE_CHECK(linear.allFinite() && angular.allFinite(), "velocities are finite");
  BulletBody& body = impl_->body(id);
  BodyState state = impl_->world.state_of(body);
  state.linear_velocity = linear;
  state.angular_velocity = angular;
  state.activation = Activation::awake;
  state.deactivation_time_s = 0;
  impl_->world.put_state(body, state);
  impl_->changed();
}

void PhysicsWorld::apply_force(BodyId id, const Eigen::Vector3f& force) {
  AUREOLE_CHECK(force.allFinite(), "a force is finite");
  impl_->body(id).rigid.applyCentralForce(to_bullet(force));
  wake(id);
}

void PhysicsWorld::wake(BodyId id) {
  BulletBody& body = impl_->body(id);
  if (!body.immovable()) body.rigid.activate(true);
  impl_->changed();
}

std::optional<RayHit> PhysicsWorld::raycast(const WorldPosition& from, const WorldPosition& to,
                                            std::optional<BodyId> ignore) const {
  return nearest_hit(impl_->world, from, to, ignore ? &impl_->body_or_stand_in(*ignore) : nullptr);
}

std::vector<BodyId> PhysicsWorld::overlapping_sphere(const WorldPosition& centre,
                                                     float radius) const {
  return bodies_in_sphere(impl_->world, centre, radius);
}

std::uint64_t PhysicsWorld::state_hash() const {
  Hasher hasher;
  for (const BulletBody* body : impl_->bodies.bodies) {
    const BodyState s = impl_->world.state_of(*body);
    hasher.add(body->id.value).add(body->prototype.value);
    hasher.add(s.position.x).add(s.position.y).add(s.position.z);
    for (int i = 0; i < 4; ++i) hasher.add(s.orientation.coeffs()[i]);
    for (int i = 0; i < 3; ++i) hasher.add(s.linear_velocity[i]).add(s.angular_velocity[i]);
    hasher.add(static_cast<std::uint8_t>(s.activation)).add(s.deactivation_time_s);
  }
  return hasher.value();
}

PhysicsStatistics PhysicsWorld::statistics() const {
  PhysicsStatistics out;
  out.pairs = static_cast<std::size_t>(impl_->world.pairs().getNumOverlappingPairs());
  out.manifolds = static_cast<std::size_t>(impl_->world.dispatcher().getNumManifolds());
  std::vector<int> tags;
  for (const BulletBody* body : impl_->bodies.bodies)
    if (!body->immovable() && body->rigid.isActive()) tags.push_back(body->rigid.getIslandTag());
  std::sort(tags.begin(), tags.end());
  out.islands = static_cast<std::size_t>(std::unique(tags.begin(), tags.end()) - tags.begin());
  return out;
}

}  // namespace aureole
