// What a region writes down of itself so that its next start can go on from there.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/region/handoff/handoff.h"
#include "server/region/players/effects.h"

namespace aureole {

/// Everything that a region alone knows after a step. Contacts among its bodies are left out: they
/// are found anew by collision detection, and only their warm start is lost.
struct Snapshot {
  struct Peer {
    RegionId region;
    /// Messages towards it that are not durable there, oldest first.
    std::vector<std::pair<FrameType, Bytes>> journal;
    /// Groups of it that have been taken but wait for their tick.
    std::vector<HandoffGroup> waiting;
  };
  Incarnation incarnation;
  Tick tick;
  /// Bodies with the epochs of this region's ownership, ascending, at most max_handoff_bodies in
  /// each piece, and the avatars among them.
  std::vector<HandoffGroup> hosted;
  std::vector<Peer> peers;
  std::vector<std::uint64_t> injected;  ///< For each injector, how many it had made.
  std::vector<BlastEffect> blasts;      ///< Recent ones and those to come.
  std::vector<std::pair<BodyId, Tick>> removals;  ///< See RegionCore::pending_removals_.
  std::vector<std::uint16_t> gateways;            ///< Linked at that moment.
};

/// Whose snapshot it is; one of another region or world is refused.
struct SnapshotOwner {
  std::uint64_t world_hash = 0;
  RegionId region;
  std::size_t regions = 0, prototypes = 0, statics = 0, injectors = 0;  ///< Of the world.
};

Bytes encode_snapshot(const Snapshot& snapshot, const SnapshotOwner& owner);

/// Checked like a message from a stranger. An Error says what was wrong with the bytes, or whose
/// they are.
Result<Snapshot> decode_snapshot(std::span<const std::byte> bytes, const SnapshotOwner& owner);

}  // namespace aureole
