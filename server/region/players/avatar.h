// A player's avatar inside its region: what the player wants, and the forces that follow from it.
#pragma once

#include <cstdint>
#include <map>

#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// What a player asks for, in the order of `sequence` within one `session`.
struct PlayerCommand {
  enum class Kind : std::uint8_t { input, throw_body, grab, blast, respawn, join, lost, leave };
  PlayerId player;
  std::uint32_t session = 0;
  std::uint32_t sequence = 0;
  Kind kind = Kind::input;
  std::uint8_t keys = 0;  ///< See Keys.
  std::uint8_t item = 0;  ///< throw_body: 0 … 3
  std::uint16_t gateway = 0;
  BodyId target;  ///< grab: the body; join: the avatar if it should exist already
  float yaw = 0, pitch = 0;
  std::uint16_t spawn = 0;  ///< join, respawn
};

namespace keys {
inline constexpr std::uint8_t forward = 1, back = 2, left = 4, right = 8, jump = 16, sprint = 32;
}

/// Everything that belongs to a player besides the body; it travels with the body in handoffs.
struct Avatar {
  PlayerId player;
  std::uint32_t session = 0;
  std::uint32_t applied_sequence = 0;
  std::uint16_t gateway = 0;
  bool connected = true;
  Tick lost_since;
  std::uint8_t keys = 0;
  float yaw = 0, pitch = 0;
  std::uint32_t thrown = 0;  ///< Bodies thrown so far; names the next one.
  BodyId carried;
  float carried_distance_m = 2.2f;
  Tick active;           ///< Of the newest command, here or since it arrived.
  Tick held_until;       ///< Commands wait until this tick; see Players::note_company().
  bool company = false;  ///< Other servers' bodies are near.
  std::map<std::uint32_t, PlayerCommand>
      waiting;  ///< Arrived ahead of their turn, at most max_waiting.

  static constexpr std::size_t max_waiting = 256;
  BodyId body() const { return BodyId::avatar(player); }
};

/// How avatars move (units in the names).
struct AvatarTuning {
  float walk_mps = 4.5f;
  float sprint_mps = 8.0f;
  float ground_acceleration_mps2 = 45.0f;
  float air_acceleration_mps2 = 12.0f;
  float jump_mps = 5.4f;
  float eye_below_top_m = 0.2f;
  float carry_gain_per_s = 12.0f;
  float carry_speed_max_mps = 14.0f;
  float carry_reach_m = 6.0f;  ///< Past it the body slips from the hand.
  float carry_mass_max_kg = 60.0f;
  float blast_radius_m = 9.0f;
  float blast_speed_mps = 13.0f;
};

/// Unit vector that an avatar looks along. Yaw 0 looks along -z and grows to the left (towards -x).
Eigen::Vector3f look_direction(float yaw, float pitch);

/// Half the height of the avatar's capsule.
float avatar_half_height(const BodyDefinition& definition);

/// Pushes the avatar (and what it carries, if that is in `world`) for one step of 16 ms. An avatar
/// without keys that stands still is left alone, so that it can fall asleep.
/// Returns false if the carried body slipped away.
bool drive_avatar(PhysicsWorld& world, const Avatar& avatar, const AvatarTuning& tuning,
                  float half_height);

}  // namespace aureole
