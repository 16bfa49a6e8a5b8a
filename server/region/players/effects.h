// What one region's players do to the bodies of all regions: blasts, removals, reaching for things.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "protocol/frame.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// A sudden push outwards; every server applies it before the same step.
struct BlastEffect {
  std::uint64_t id = 0;  ///< Unique: player and command.
  Tick tick;
  WorldPosition position;
  float radius_m = 0;
  float speed_mps = 0;  ///< Velocity change at the centre; falls linearly to 0 at the radius.
  BodyId spared;        ///< The avatar that caused it.
};

/// A player reaches for a body that another region owns.
struct BodyRequest {
  BodyId body;
  PlayerId player;
};

struct EffectsMessage {
  std::vector<BlastEffect> blasts;
  std::vector<BodyId> removals;
  std::vector<BodyRequest> requests;
  /// Of each kind in one message at most; see RegionCore::send_player_output().
  static constexpr std::size_t max_of_a_kind = 4096;
  bool empty() const { return blasts.empty() && removals.empty() && requests.empty(); }
};

Bytes encode_effects(const EffectsMessage& message);
Result<EffectsMessage> decode_effects(std::span<const std::byte> payload);

/// Pushes the bodies of `world` that lie within the blast and wakes them. Light and heavy bodies
/// fly alike: the game is in the flight, not in the mass.
void apply_blast(PhysicsWorld& world, const BlastEffect& blast);

}  // namespace aureole
