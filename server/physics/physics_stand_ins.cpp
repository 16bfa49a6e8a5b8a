// Bodies and stand-ins by id: how each comes, and how the one becomes the other.
#include <algorithm>

#include "server/base/check.h"
#include "server/base/prefetch.h"
#include "server/physics/bullet/bullet_contacts.h"
#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/physics_world_impl.h"

namespace aureole {
namespace {

/// Contacts are worth carrying over if no point of the shape has moved further (m).
constexpr double same_place_m = 1e-3;

/// How far any point of a body can be from where it was, at most (m).
double displacement(const BodyState& from, const BodyState& to, const Shape& shape) {
  const double angle = double{from.orientation.angularDistance(to.orientation)};
  return distance(from.position, to.position) + angle * double{bounding_radius(shape)};
}

}  // namespace

void PhysicsWorld::add(std::span<const NewBody> bodies) {
  const std::vector<NewBody> sorted = sorted_by_id(bodies);
  const auto definitions = impl_->world.shapes().prototypes();
  // A stand-in that stood elsewhere, or was another thing, leaves before its namesake comes.
  std::vector<BulletBody*> thawing, leaving;
  for (const NewBody& one : sorted) {
    BulletBody* stand_in = impl_->find(one.id);
    if (!stand_in) continue;
    AUREOLE_CHECK(stand_in->role == Role::stand_in, "a body is added once");
    const bool same = stand_in->prototype == one.prototype &&
                      displacement(impl_->world.state_of(*stand_in), one.state,
                                   definitions[one.prototype.value].shape) <= same_place_m;
    (same ? thawing : leaving).push_back(stand_in);
  }
  impl_->destroy(impl_->stand_ins, leaving, Wake::nobody);
  impl_->stand_ins.leave(thawing);

  std::vector<BulletBody*> added;
  for (const NewBody& one : sorted) {
    BulletBody* stand_in = impl_->find(one.id);
    if (stand_in) impl_->world.thaw(*stand_in, one.state);
    added.push_back(stand_in ? stand_in : impl_->create(one, Role::body));
  }
  impl_->bodies.merge(added);
  impl_->changed();
}

void PhysicsWorld::find_contacts(std::span<const BodyId> sleepers) {
  detect_contacts(impl_->world, impl_->group_of(sleepers, &Impl::body),
                  impl_->world.pairs().getNumOverlappingPairs());
  impl_->changed();
}

void PhysicsWorld::add_stand_ins(std::span<const NewBody> bodies) {
  std::vector<BulletBody*> fresh, moved;
  const int pairs_before = impl_->world.pairs().getNumOverlappingPairs();
  for (const NewBody& one : sorted_by_id(bodies)) {
    BulletBody* here = impl_->find(one.id);
    if (here) {
      AUREOLE_CHECK(here->role == Role::stand_in && here->prototype == one.prototype,
                    "a stand-in is moved by its own name and prototype");
      impl_->world.put_state(*here, one.state);
      impl_->world.moved_by_hand(*here, Wake::nobody);
      moved.push_back(here);
    } else {
      fresh.push_back(impl_->create(one, Role::stand_in));
    }
  }
  impl_->stand_ins.merge(fresh);
  // A pair of a stand-in and a sleeping body would not be looked at before the body wakes.
  detect_contacts(impl_->world, moved, pairs_before);
  impl_->changed();
}

void PhysicsWorld::wake_what_is_inside(std::span<const BodyId> stand_ins, float deeper_than_m) {
  for (const BodyId id : stand_ins) {
    const BulletBody& stand_in = impl_->stand_in(id);
    for (const auto& [manifold, inside] : stand_in.contact_edges) {
      if (inside == nullptr || inside->immovable()) continue;
      for (int p = 0; p < manifold->getNumContacts(); ++p)
        if (manifold->getContactPoint(p).getDistance() < -deeper_than_m)
          inside->rigid.activate(true);
    }
  }
  impl_->changed();
}

void PhysicsWorld::remove_stand_ins(std::span<const BodyId> ids, Wake wake) {
  impl_->destroy(impl_->stand_ins, impl_->group_of(ids, &Impl::stand_in), wake);
}

void PhysicsWorld::turn_into_stand_ins(std::span<const BodyId> ids) {
  if (ids.empty()) return;
  const std::vector<BulletBody*> group = impl_->group_of(ids, &Impl::body);
  for (const BulletBody* body : group)
    AUREOLE_CHECK(body->role == Role::body, "only a body becomes a stand-in");
  impl_->world.freeze(group);
  impl_->bodies.leave(group);
  impl_->stand_ins.merge(group);
  impl_->changed();
}

std::span<const BodyId> PhysicsWorld::stand_in_ids() const {
  return impl_->stand_ins.ids;
}

bool PhysicsWorld::is_stand_in(BodyId id) const {
  const BulletBody* found = impl_->find(id);
  return found && found->role == Role::stand_in;
}

NewBody PhysicsWorld::stand_in(BodyId id) const {
  const BulletBody& found = impl_->stand_in(id);
  return {id, found.prototype, impl_->world.state_of(found)};
}

void PhysicsWorld::stand_in_loads(std::vector<StandInLoad>& out) const {
  constexpr std::size_t ahead = 8;
  const std::vector<BulletBody*>& all = impl_->stand_ins.bodies;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (n + ahead < all.size()) prefetch(&all[n + ahead]->contact_edges);
    append_loads(*all[n], out);
  }
}

}  // namespace aureole
