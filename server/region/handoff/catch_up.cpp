// The scratch world in which a late group is stepped to the present.
#include "server/region/handoff/catch_up.h"

#include <algorithm>
#include <set>

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

bool may_all_travel(const PhysicsWorld& scratch, std::span<const BodyId> ids) {
  return std::all_of(ids.begin(), ids.end(),
                     [&](BodyId id) { return may_travel(scratch.state(id)); });
}

}  // namespace

void catch_up(HandoffGroup& group, const CatchUpSurroundings& around) {
  const std::int64_t steps = around.host_tick - group.tick;
  const bool all_asleep = std::all_of(group.bodies.begin(), group.bodies.end(), [](const auto& b) {
    return b.body.state.activation == Activation::asleep;
  });
  const bool blasted = std::any_of(around.blasts.begin(), around.blasts.end(), [&](const auto& b) {
    return b.tick > group.tick && b.tick <= around.host_tick;
  });
  if (steps <= 0 || (all_asleep && !blasted)) {
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
  group.contacts = scratch.contacts_within(ids);
  group.tick = around.host_tick;
}

}  // namespace aureole
