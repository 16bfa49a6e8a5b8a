// While a region is down, its boundary is a wall to its neighbours' bodies.
#pragma once

#include <span>

#include "server/aura/partition_map.h"
#include "server/base/ids.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// Call before each physics step of `dt_s` (s). An awake body whose centre is outside the areas of
/// the regions in `closed` and would be inside one of them after the step loses the part of its
/// velocity that leads in. Bodies that are already across are let be.
void hold_back(PhysicsWorld& physics, const PartitionMap& map, std::span<const RegionId> closed,
               float dt_s);

}  // namespace aureole
