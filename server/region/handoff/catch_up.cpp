// The scratch world in which a late group is stepped to the present.
#include "server/region/handoff/catch_up.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

/// Bodies of the host that the group can reach in the time to make up, where they were at its
/// start.
std::vector<NewBody> obstacles_for(const HandoffGroup& group, const CatchUpSurroundings& around,
                                   float seconds) {
  std::set<BodyId> near;
  for (const auto& b : group.bodies) {
    const BodyState& state = b.body.state;
    const float size = bounding_radius(around.prototypes[b.body.prototype.value].shape);
    const float reach = size + state.linear_velocity.norm() * seconds + 0.5f;
    for (BodyId id : around.host.overlapping_sphere(state.position, reach)) near.insert(id);
  }
  // A body that both sides claim is no obstacle to itself.
  for (const auto& b : group.bodies) near.erase(b.body.id);
  std::vector<NewBody> obstacles;
  for (BodyId id : near) {
    BodyState state = around.host.state(id);
    const Eigen::Vector3d travelled = (state.linear_velocity * seconds).cast<double>();
    state.position = WorldPosition::from(Eigen::Vector3d(state.position.vector() - travelled));
    obstacles.push_back({id, around.host.prototype(id), state});
  }
  return obstacles;
}

/// The group's own stand-ins, and the host's within reach.
std::vector<NewBody> walls_for(const HandoffGroup& group, const CatchUpSurroundings& around,
                               float seconds) {
  std::map<BodyId, NewBody> walls;
  for (const NewBody& body : group.stand_ins)
    if (!around.host.contains(body.id)) walls.emplace(body.id, body);
  for (BodyId id : around.host.stand_in_ids()) {
    const NewBody wall = around.host.stand_in(id);
    const float size = bounding_radius(around.prototypes[wall.prototype.value].shape);
    const bool near = std::any_of(group.bodies.begin(), group.bodies.end(), [&](const auto& b) {
      const BodyState& state = b.body.state;
      const float own = bounding_radius(around.prototypes[b.body.prototype.value].shape);
      const float reach = size + own + state.linear_velocity.norm() * seconds + 0.5f;
      return distance(state.position, wall.state.position) < double{reach};
    });
    if (near) walls.emplace(id, wall);
  }
  for (const auto& b : group.bodies) walls.erase(b.body.id);
  std::vector<NewBody> all;
  for (const auto& [id, wall] : walls) all.push_back(wall);
  return all;
}

bool may_all_travel(const PhysicsWorld& scratch, std::span<const BodyId> ids) {
  return std::all_of(ids.begin(), ids.end(),
                     [&](BodyId id) { return may_travel(scratch.state(id)); });
}

}  // namespace

void catch_up(HandoffGroup& group, const CatchUpSurroundings& around) {
  const std::int64_t steps = around.host_tick - group.tick;
  const bool all_still = std::all_of(group.bodies.begin(), group.bodies.end(), [](const auto& b) {
    return b.body.state.activation == Activation::asleep || b.still_ticks >= resting_ticks;
  });
  const bool blasted = std::any_of(around.blasts.begin(), around.blasts.end(), [&](const auto& b) {
    return b.tick > group.tick && b.tick <= around.host_tick;
  });
  if (steps <= 0 || (all_still && !blasted)) {
    group.tick = std::max(group.tick, around.host_tick);
    return;
  }

  const float seconds = static_cast<float>(steps) * tick_s;
  const auto obstacles = obstacles_for(group, around, seconds);
  PhysicsWorld scratch = around.host.scratch(group.bodies.size() + obstacles.size());
  std::vector<NewBody> bodies;
  std::vector<BodyId> ids;
  for (const auto& b : group.bodies) {
    bodies.push_back(b.body);
    ids.push_back(b.body.id);
  }
  scratch.add(bodies);
  for (const auto& obstacle : obstacles) scratch.add_obstacle(obstacle);
  scratch.add_stand_ins(walls_for(group, around, seconds));
  scratch.install_contacts(group.contacts);

  for (Tick tick = group.tick + 1; tick <= around.host_tick; tick = tick + 1) {
    for (const auto& blast : around.blasts)
      if (blast.tick == tick) apply_blast(scratch, blast);
    for (const auto& avatar : group.avatars) {
      const auto& definition = around.prototypes[scratch.prototype(avatar.body()).value];
      drive_avatar(scratch, avatar, around.tuning, avatar_half_height(definition));
    }
    scratch.step(tick_s);
    // Whatever made the numbers burst (contacts come from outside), the group arrives as it was
    // sent.
    if (!may_all_travel(scratch, ids)) {
      group.contacts.clear();
      group.tick = around.host_tick;
      return;
    }
  }

  for (auto& b : group.bodies) b.body.state = scratch.state(b.body.id);
  group.contacts = scratch.contacts_around(ids);
  // Those with obstacles are left to collision detection: the host's bodies are not where they
  // were.
  std::erase_if(group.contacts, [&](const ContactManifold& manifold) {
    const auto is_obstacle = [&](BodyId id) {
      return around.host.contains(id) && !scratch.is_stand_in(id);
    };
    const auto* b = std::get_if<BodyId>(&manifold.b);
    return is_obstacle(manifold.a) || (b != nullptr && is_obstacle(*b));
  });
  group.tick = around.host_tick;
}

}  // namespace aureole
