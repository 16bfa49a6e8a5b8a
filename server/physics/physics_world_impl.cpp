// Keeping the lists of a PhysicsWorld in step with the Bullet world.
#include "server/physics/physics_world_impl.h"

#include <algorithm>

#include "server/base/check.h"

namespace aureole {
namespace {

bool by_ascending_id(const BulletBody* x, const BulletBody* y) {
  return x->id < y->id;
}

}  // namespace

void BodyList::merge(std::span<BulletBody* const> sorted) {
  // Both lists have the same order, and only the ids lie in a row: bodies are not looked at.
  auto end = static_cast<std::ptrdiff_t>(ids.size());
  ids.resize(ids.size() + sorted.size());
  bodies.resize(ids.size());
  for (auto behind = static_cast<std::ptrdiff_t>(sorted.size()); behind > 0; --behind) {
    BulletBody* const body = sorted[static_cast<std::size_t>(behind - 1)];
    const auto at = std::upper_bound(ids.begin(), ids.begin() + end, body->id) - ids.begin();
    std::move_backward(ids.begin() + at, ids.begin() + end, ids.begin() + end + behind);
    std::move_backward(bodies.begin() + at, bodies.begin() + end, bodies.begin() + end + behind);
    ids[static_cast<std::size_t>(at + behind - 1)] = body->id;
    bodies[static_cast<std::size_t>(at + behind - 1)] = body;
    end = at;
  }
}

void BodyList::leave(std::span<BulletBody* const> sorted) {
  // What lies between two that leave moves down as one block.
  auto from = ids.begin(), to = ids.begin();
  const auto keep_until = [&](auto next) {
    if (from != to) {
      const auto first = from - ids.begin(), last = next - ids.begin(), place = to - ids.begin();
      std::copy(bodies.begin() + first, bodies.begin() + last, bodies.begin() + place);
      std::copy(from, next, to);
    }
    to += next - from;
  };
  for (const BulletBody* body : sorted) {
    const auto at = std::lower_bound(from, ids.end(), body->id);
    if (at == ids.end() || *at != body->id) continue;
    keep_until(at);
    from = at + 1;
  }
  keep_until(ids.end());
  bodies.resize(static_cast<std::size_t>(to - ids.begin()));
  ids.erase(to, ids.end());
}

PhysicsWorld::Impl::Impl(const PhysicsSettings& settings, std::unique_ptr<ShapeLibrary> own,
                         ShapeLibrary& library, std::size_t expected_bodies)
    : own_shapes(std::move(own)), world(settings, library, expected_bodies) {
  by_id.reserve(expected_bodies);
}

PhysicsWorld::Impl::~Impl() {
  world.erase_all(bodies.bodies);
  world.erase_all(stand_ins.bodies);
}

BulletBody* PhysicsWorld::Impl::find(BodyId id) const {
  const auto found = by_id.find(id);
  return found == by_id.end() ? nullptr : found->second.get();
}

BulletBody& PhysicsWorld::Impl::body(BodyId id) const {
  BulletBody* found = find(id);
  AUREOLE_CHECK(found && found->role != Role::stand_in, "the body is in this world");
  return *found;
}

BulletBody& PhysicsWorld::Impl::stand_in(BodyId id) const {
  BulletBody* found = find(id);
  AUREOLE_CHECK(found && found->role == Role::stand_in, "the stand-in is in this world");
  return *found;
}

BulletBody& PhysicsWorld::Impl::body_or_stand_in(BodyId id) const {
  BulletBody* found = find(id);
  AUREOLE_CHECK(found, "the body or stand-in is in this world");
  return *found;
}

std::vector<BulletBody*> PhysicsWorld::Impl::group_of(std::span<const BodyId> group,
                                                      BulletBody& (Impl::*get)(BodyId)
                                                          const) const {
  std::vector<BulletBody*> out;
  out.reserve(group.size());
  for (BodyId id : group) out.push_back(&(this->*get)(id));
  std::sort(out.begin(), out.end(), by_ascending_id);
  AUREOLE_CHECK(std::adjacent_find(out.begin(), out.end()) == out.end(),
                "a group names each body once");
  return out;
}

BulletBody* PhysicsWorld::Impl::create(const NewBody& body, Role role) {
  const auto [place, fresh] = by_id.try_emplace(body.id);
  AUREOLE_CHECK(fresh, "a body is added once");
  place->second = world.make_body(body, role);
  BulletBody& made = *place->second;
  if (free_slots.empty()) {
    made.slot = static_cast<std::uint32_t>(by_slot.size());
    by_slot.push_back(&made);
  } else {
    made.slot = free_slots.back();
    free_slots.pop_back();
    by_slot[made.slot] = &made;
  }
  world.insert(made);
  return &made;
}

void PhysicsWorld::Impl::destroy(BodyList& list, std::span<BulletBody* const> sorted, Wake wake) {
  if (sorted.empty()) return;
  world.erase(sorted, wake);
  list.leave(sorted);
  for (BulletBody* body : sorted) {
    free_slots.push_back(body->slot);
    by_id.erase(body->id);
  }
  changed();
}

void PhysicsWorld::Impl::changed() {
  awake_count.reset();
  awake_is_current = false;
}

std::vector<NewBody> sorted_by_id(std::span<const NewBody> bodies) {
  std::vector<NewBody> sorted(bodies.begin(), bodies.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const NewBody& x, const NewBody& y) { return x.id < y.id; });
  return sorted;
}

}  // namespace aureole
