// Range checks for everything a region says about its bodies.
#include "server/replica/replica_wire.h"

#include <cmath>

#include "protocol/quantise.h"
#include "protocol/wire_values.h"
#include "server/replica/slot_table.h"

namespace aureole {
namespace {

bool in_the_world(const wire::Vec3d& p) {
  // Written so that NaN fails.
  return std::abs(p.x()) <= position_limit_m && std::abs(p.y()) <= position_limit_m &&
         std::abs(p.z()) <= position_limit_m;
}

Status check_owner(std::uint64_t id, const wire::ReplicaVersion& version, RegionId from) {
  if (!BodyId{id}.valid()) return Error::format("body {:#x} is not a name of any body", id);
  if (version.region() != from.value)
    return Error::format("body {:#x} came with a version of region {}; expected {}, its sender", id,
                         version.region(), from.value);
  return Ok{};
}

}  // namespace

Version version_of(const wire::ReplicaVersion& v) {
  return {v.epoch(), Incarnation{v.incarnation()}, RegionId{v.region()}};
}

BodyState state_of(const wire::ReplicaKey& key) {
  BodyState state;
  state.position = from_wire(key.position());
  state.orientation = from_wire(key.orientation());
  state.linear_velocity = from_wire(key.linear_velocity());
  state.angular_velocity = from_wire(key.angular_velocity());
  state.activation = static_cast<Activation>(key.activation());
  state.deactivation_time_s = key.deactivation_time_s();
  return state;
}

Status check_tick(std::int64_t tick) {
  if (tick < -replica_tick_max || tick > replica_tick_max)
    return Error::format("replica update of tick {}; expected at most {} from 0", tick,
                         replica_tick_max);
  return Ok{};
}

Status check_key(const wire::ReplicaKey& key, RegionId from, std::size_t prototype_count) {
  const std::uint64_t id = key.id();
  if (auto ok = check_owner(id, key.version(), from); !ok) return ok;
  if (key.slot() >= replica_slots_max)
    return Error::format("body {:#x} in slot {}; expected less than {}", id, key.slot(),
                         replica_slots_max);
  if (key.prototype() >= prototype_count)
    return Error::format("body {:#x} of prototype {}; this world has {}", id, key.prototype(),
                         prototype_count);
  if (key.activation() > static_cast<std::uint8_t>(Activation::asleep))
    return Error::format("body {:#x} in activation state {}; expected 0 to 2", id,
                         key.activation());
  if (!in_the_world(key.position()))
    return Error::format("body {:#x} at ({}, {}, {}); expected at most {} m along each axis", id,
                         key.position().x(), key.position().y(), key.position().z(),
                         position_limit_m);
  const BodyState state = state_of(key);
  const float length = state.orientation.norm();
  if (!(std::abs(length - 1) <= replica_orientation_slack))
    return Error::format("body {:#x} with an orientation of length {}; expected 1", id, length);
  if (!state.linear_velocity.allFinite() || !state.angular_velocity.allFinite() ||
      !std::isfinite(state.deactivation_time_s))
    return Error::format("body {:#x} with a velocity or sleeping time that is not finite", id);
  return Ok{};
}

Status check_removed(const wire::ReplicaRemoved& removed, RegionId from) {
  return check_owner(removed.id(), removed.version(), from);
}

Status check_player(const wire::PlayerStatus& player) {
  if (player.player() == 0) return Error{"status of player 0; expected a number from 1"};
  if (player.session() > session_max)
    return Error::format("player {} in session {}; expected at most {}", player.player(),
                         player.session(), session_max);
  if (player.carried() != 0 && !BodyId{player.carried()}.valid())
    return Error::format("player {} carries {:#x}, which is not a name of any body",
                         player.player(), player.carried());
  return Ok{};
}

}  // namespace aureole
