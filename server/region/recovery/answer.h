// What servers tell a region that recovers: which versions of bodies exist, and states of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/physics/body.h"
#include "server/region/recovery/traces.h"

namespace aureole {

/// A body as it was under a version.
struct KnownState {
  NewBody body;
  Version version;
};

/// What a replica store knows of a player whose avatar a region owned.
struct KnownPlayer {
  PlayerId player;
  std::uint32_t session = 0;
  std::uint32_t applied_sequence = 0;
  BodyId carried;
};

struct RecoveryAnswer {
  std::uint64_t round = 0;  ///< Of the question; 0: the sender has finished its own recovery.
  bool complete = true;     ///< The last frame of the answer.
  bool recovering = false;  ///< The sender could claim the `states` itself.
  Tick heard{-1};           ///< Gateways: newest tick of the region that asks; -1: none.
  std::vector<Trace> traces;
  std::vector<KnownState> states;
  std::vector<KnownPlayer> players;
};

SharedBytes encode_recovery_query(std::uint64_t round);
Result<std::uint64_t> decode_recovery_query(std::span<const std::byte> payload);

/// In as many frames as it takes.
std::vector<SharedBytes> encode_recovery_answer(const RecoveryAnswer& answer);
/// Verified and checked: ids valid, regions and prototypes of this world, numbers finite.
Result<RecoveryAnswer> decode_recovery_answer(std::span<const std::byte> payload,
                                              std::size_t regions, std::size_t prototypes);

}  // namespace aureole
