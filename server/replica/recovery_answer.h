// What a replica store tells a region that has died and starts anew.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/replica/replica_store.h"

namespace aureole {

/// Frames that answer a FrameType::recovery_query of region `asks`: the newest state of every body
/// of the world, all removals that are remembered, and what is known of players. An Error (not a
/// query) means that the link must be closed.
Result<std::vector<SharedBytes>> answer_recovery(const ReplicaStore& store, RegionId asks,
                                                 std::span<const std::byte> query);

}  // namespace aureole
