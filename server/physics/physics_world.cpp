// Bodies by id on top of the Bullet world: the plain-data surface of this room.
#include "server/physics/physics_world.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "server/base/check.h"
#include "server/base/hash.h"
#include "server/physics/bullet/bullet_contacts.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/bullet/bullet_shapes.h"
#include "server/physics/bullet/bullet_world.h"

namespace aureole {

struct PhysicsWorld::Impl {
  Impl(const PhysicsSettings& settings, std::unique_ptr<ShapeLibrary> own, ShapeLibrary& library,
       std::size_t expected_bodies)
      : own_shapes(std::move(own)), world(settings, library, expected_bodies) {
    by_id.reserve(expected_bodies);
  }
  ~Impl() { world.erase_all(bodies); }

  BulletBody& body(BodyId id) const {
    const auto found = by_id.find(id);
    AUREOLE_CHECK(found != by_id.end(), "the body is in this world");
    return *found->second;
  }

  /// Makes the bodies of a sorted list and adds them; `ids` and `bodies` stay ascending.
  void add_sorted(std::span<const NewBody> sorted, bool obstacles);
  std::vector<BulletBody*> group_of(std::span<const BodyId> group) const;

  // Bullet's world knows the bodies and the bodies the shapes: the order below is that of dying.
  std::unique_ptr<ShapeLibrary> own_shapes;  ///< Null in a scratch world.
  std::unordered_map<BodyId, std::unique_ptr<BulletBody>> by_id;
  std::vector<BodyId> ids;          ///< Ascending.
  std::vector<BulletBody*> bodies;  ///< In the order of `ids`.
  mutable BulletWorld world;        ///< Bullet's queries are not const; they change nothing.
  mutable std::optional<std::size_t> awake;
};

void PhysicsWorld::Impl::add_sorted(std::span<const NewBody> sorted, bool obstacles) {
  const auto middle = static_cast<std::ptrdiff_t>(ids.size());
  for (const NewBody& one : sorted) {
    const auto [place, fresh] = by_id.try_emplace(one.id);
    AUREOLE_CHECK(fresh, "a body is added once");
    place->second = world.make_body(one, obstacles);
    world.insert(*place->second);
    ids.push_back(one.id);
    bodies.push_back(place->second.get());
  }
  std::inplace_merge(ids.begin(), ids.begin() + middle, ids.end());
  std::inplace_merge(bodies.begin(), bodies.begin() + middle, bodies.end(),
                     [](const BulletBody* x, const BulletBody* y) { return x->id < y->id; });
  awake.reset();
}

std::vector<BulletBody*> PhysicsWorld::Impl::group_of(std::span<const BodyId> group) const {
  std::vector<BulletBody*> out;
  out.reserve(group.size());
  for (BodyId id : group) out.push_back(&body(id));
  std::sort(out.begin(), out.end(),
            [](const BulletBody* x, const BulletBody* y) { return x->id < y->id; });
  AUREOLE_CHECK(std::adjacent_find(out.begin(), out.end()) == out.end(),
                "a group names each body once");
  return out;
}

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

void PhysicsWorld::add(std::span<const NewBody> bodies) {
  std::vector<NewBody> sorted(bodies.begin(), bodies.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const NewBody& x, const NewBody& y) { return x.id < y.id; });
  impl_->add_sorted(sorted, false);
}

void PhysicsWorld::add_obstacle(const NewBody& body) {
  impl_->add_sorted(std::span(&body, 1), true);
}

void PhysicsWorld::remove(std::span<const BodyId> ids) {
  if (ids.empty()) return;
  const std::vector<BulletBody*> group = impl_->group_of(ids);
  impl_->world.erase(group);
  // Both lists ascend: one walk takes the group out of either.
  const auto leave = [&](auto& list, auto id_of) {
    auto next = group.begin();
    std::erase_if(list, [&](const auto& entry) {
      if (next == group.end() || id_of(entry) != (*next)->id) return false;
      ++next;
      return true;
    });
  };
  leave(impl_->ids, [](BodyId id) { return id; });
  leave(impl_->bodies, [](const BulletBody* body) { return body->id; });
  for (BulletBody* body : group) impl_->by_id.erase(body->id);
  impl_->awake.reset();
}

void PhysicsWorld::install_contacts(std::span<const ContactManifold> contacts) {
  const auto object_for = [&](const ContactPartner& partner) -> btCollisionObject* {
    if (const BodyId* id = std::get_if<BodyId>(&partner)) {
      const auto found = impl_->by_id.find(*id);
      return found == impl_->by_id.end() ? nullptr : &found->second->rigid;
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
}

std::vector<ContactManifold> PhysicsWorld::contacts_within(std::span<const BodyId> group) const {
  return extract_contacts(impl_->world, impl_->group_of(group));
}

std::vector<BodyId> PhysicsWorld::touching(BodyId id) const {
  return bodies_touching(impl_->world, impl_->body(id));
}

bool PhysicsWorld::is_supported(BodyId id, float min_up) const {
  return has_support(impl_->world, impl_->body(id), min_up);
}

void PhysicsWorld::step(float dt_s) {
  AUREOLE_CHECK(dt_s > 0, "a step takes time");
  impl_->world.step(dt_s, impl_->bodies);
  impl_->awake.reset();
}

bool PhysicsWorld::contains(BodyId id) const {
  return impl_->by_id.contains(id);
}
std::size_t PhysicsWorld::size() const {
  return impl_->ids.size();
}

std::size_t PhysicsWorld::awake_count() const {
  if (!impl_->awake)
    impl_->awake = static_cast<std::size_t>(
        std::count_if(impl_->bodies.begin(), impl_->bodies.end(),
                      [](const BulletBody* body) { return body->rigid.isActive(); }));
  return *impl_->awake;
}

std::span<const BodyId> PhysicsWorld::ids() const {
  return impl_->ids;
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
    impl_->world.moved_by_hand(body);
  impl_->awake.reset();
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
  impl_->awake.reset();
}

void PhysicsWorld::apply_force(BodyId id, const Eigen::Vector3f& force) {
  AUREOLE_CHECK(force.allFinite(), "a force is finite");
  impl_->body(id).rigid.applyCentralForce(to_bullet(force));
  wake(id);
}

void PhysicsWorld::wake(BodyId id) {
  BulletBody& body = impl_->body(id);
  if (!body.obstacle) body.rigid.activate(true);
  impl_->awake.reset();
}

std::optional<RayHit> PhysicsWorld::raycast(const WorldPosition& from, const WorldPosition& to,
                                            std::optional<BodyId> ignore) const {
  return nearest_hit(impl_->world, from, to, ignore ? &impl_->body(*ignore) : nullptr);
}

std::vector<BodyId> PhysicsWorld::overlapping_sphere(const WorldPosition& centre,
                                                     float radius) const {
  return bodies_in_sphere(impl_->world, centre, radius);
}

std::uint64_t PhysicsWorld::state_hash() const {
  Hasher hasher;
  for (const BulletBody* body : impl_->bodies) {
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
  for (const BulletBody* body : impl_->bodies)
    if (!body->obstacle && body->rigid.isActive()) tags.push_back(body->rigid.getIslandTag());
  std::sort(tags.begin(), tags.end());
  out.islands = static_cast<std::size_t>(std::unique(tags.begin(), tags.end()) - tags.begin());
  return out;
}

}  // namespace aureole
