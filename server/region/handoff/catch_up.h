// Makes up the time that a group spent in flight: steps it in a small world of its own to our tick.
#pragma once

#include <span>

#include "server/base/tick.h"
#include "server/physics/physics_world.h"
#include "server/region/handoff/handoff.h"
#include "server/region/players/avatar.h"
#include "server/region/players/effects.h"

namespace aureole {

/// What a group may meet on its way.
struct CatchUpSurroundings {
  std::span<const BodyDefinition> prototypes;
  const PhysicsWorld& host;  ///< Its state is of tick `host_tick`.
  Tick host_tick;
  std::span<const BlastEffect> blasts;  ///< Recent ones, by tick.
  const AvatarTuning& tuning;
};

/// Brings `group` from its own tick to `host_tick`. Bullet cannot step a part of a world, so this
/// happens in a scratch world: the group with its contacts and its stand-ins, the static geometry,
/// and what stands in the way as obstacles that fly on as they fly now. Groups of which every body
/// lies still are returned as they are.
/// The paper leaves this gap in time open.
void catch_up(HandoffGroup& group, const CatchUpSurroundings& around);

}  // namespace aureole
