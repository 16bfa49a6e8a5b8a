// The players whose avatars this region hosts: their commands, in order and once each, and their
// deeds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/region/hosting.h"
#include "server/region/players/avatar.h"
#include "server/region/players/effects.h"
#include "server/worlds/world.h"

namespace aureole {

/// What players' deeds ask of other regions; collected in a step, sent at its end.
struct PlayerOutput {
  EffectsMessage effects;                                    ///< To all regions.
  std::map<RegionId, std::vector<PlayerCommand>> forwarded;  ///< Commands that follow their avatar.
};

class Players {
 public:
  Players(const WorldDefinition& world, const PartitionMap& map, RegionId self, Hosting& hosting);

  /// Takes a command: applies it if it is its turn, keeps it if it is early, forwards it if the
  /// avatar has moved on, drops it if it has been applied before. `room` says whether the world may
  /// grow by another body.
  void command(const PlayerCommand& command, Tick now, bool room, PlayerOutput& out);

  /// Moves all avatars and what they carry; call once before each physics step. Removes avatars
  /// whose players have been gone for `keep_lost_ticks`, with all that they threw.
  void drive(Tick now, bool room, PlayerOutput& out);

  /// Whether the player holds a key or has done anything lately, so that a throw or a step may
  /// follow at any moment: the avatar's aura covers it. What an idle one does is held back for as
  /// long as its aura needs to be heard of, if there is company: bodies of other servers, or a
  /// boundary, within its reach.
  bool in_play(const Avatar& avatar, Tick now) const;
  void note_company(PlayerId player, bool company);
  /// A neighbour simulates again, or we do: neither has heard of what the other one has near to our
  /// avatars. What players do waits until both have, and what they may strike has come.
  void hold_all(Tick now) { held_until_ = std::max(held_until_, now + hold_ticks_); }
  static constexpr std::int64_t idle_ticks = ticks_from_ms(2'000);

  /// A gateway's link is gone: its players are, until they come back by some gateway.
  void gateway_down(std::uint16_t gateway, Tick now);

  /// Takes the avatars among `ids` out, because their bodies leave for `to`.
  std::vector<Avatar> release(std::span<const BodyId> ids, RegionId to, Tick now);
  /// Avatars that arrived with their bodies, and things that arrived because players reached for
  /// them.
  void accept(std::vector<Avatar> avatars, std::span<const BodyId> arrived, Tick now, bool room,
              PlayerOutput& out);
  /// Bodies that are gone can be carried no longer.
  void forget(BodyId removed);

  /// The avatar that carries the body, or none.
  BodyId carrier_of(BodyId body) const;
  /// Ascending by player.
  std::vector<const Avatar*> avatars() const;
  bool is_avatar_here(PlayerId player) const { return avatars_.contains(player); }
  void respawn(PlayerId player, std::uint16_t spawn);

  static constexpr std::int64_t keep_lost_ticks = ticks_from_ms(30'000);
  static constexpr std::int64_t stop_lost_ticks = ticks_from_ms(500);
  static constexpr std::int64_t reach_ticks = ticks_from_ms(1'000);
  static constexpr std::int64_t remember_moved_ticks = ticks_from_ms(30'000);

 private:
  void join(const PlayerCommand& command, Tick now, bool room, PlayerOutput& out);
  void apply(Avatar& avatar, const PlayerCommand& command, Tick now, bool room, PlayerOutput& out);
  void apply_waiting(PlayerId player, Tick now, bool room, PlayerOutput& out);
  void throw_body(Avatar& avatar, const PlayerCommand& command, bool room, PlayerOutput& out);
  void grab(Avatar& avatar, BodyId target, Tick now, PlayerOutput& out);
  bool attach(Avatar& avatar, BodyId body);
  void blast(const Avatar& avatar, const PlayerCommand& command, Tick now, PlayerOutput& out);
  void remove_avatar(PlayerId player, PlayerOutput& out);
  void remove_thrown(PlayerId player, std::uint32_t n, PlayerOutput& out);
  BodyState standing_at(std::uint16_t spawn, PlayerId player) const;
  WorldPosition eye(const Avatar& avatar) const;

  const WorldDefinition& world_;
  const PartitionMap& map_;
  RegionId self_;
  Hosting& hosting_;
  AvatarTuning tuning_;
  float half_height_;
  std::int64_t blast_lead_ticks_;
  std::int64_t wind_up_ticks_, hold_ticks_;
  Tick held_until_;  ///< See hold_all().
  std::map<PlayerId, Avatar> avatars_;
  struct Moved {
    RegionId to;
    std::uint32_t session;
    Tick when;
  };
  std::map<PlayerId, Moved> moved_;  ///< Where avatars went that were here.
  struct Reach {
    BodyId target;
    Tick since;
  };
  std::map<PlayerId, Reach> reaching_;  ///< For bodies that other regions own.
};

}  // namespace aureole
