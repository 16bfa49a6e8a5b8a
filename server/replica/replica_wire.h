// Judges the numbers of a ReplicaUpdate, which the verifier has not looked at.
#pragma once

#include "protocol/wire.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/physics/body.h"

namespace aureole {

/// Ticks on the wire are at most this far from 0, so that world times stay far inside 64 bits.
inline constexpr std::int64_t replica_tick_max = std::int64_t{1} << 40;
/// An orientation's length may be off 1 by this much (Bullet's own drift stays below 1e-5).
inline constexpr float replica_orientation_slack = 1e-3f;

Version version_of(const wire::ReplicaVersion& v);
BodyState state_of(const wire::ReplicaKey& key);

/// Each Error names the body or player, what was found and what was expected.
Status check_tick(std::int64_t tick);
/// `from` speaks only for itself: versions of other regions are refused, so no region can outbid
/// another one by mistake.
Status check_key(const wire::ReplicaKey& key, RegionId from, std::size_t prototype_count);
Status check_removed(const wire::ReplicaRemoved& removed, RegionId from);
Status check_player(const wire::PlayerStatus& player);

}  // namespace aureole
