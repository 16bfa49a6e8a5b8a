// A player whose commands come one after the other, as a gateway numbers them.
#pragma once

#include <optional>

#include "tests/support/region_cluster.h"

namespace aureole::testing {

class ActingPlayer {
 public:
  ActingPlayer(RegionCluster& cluster, PlayerId player, float yaw = 0)
      : cluster_(cluster), player_(player), yaw_(yaw) {}

  /// The next command, looking where the player looks.
  PlayerCommand next(PlayerCommand::Kind kind) {
    PlayerCommand command;
    command.player = player_;
    command.session = 1;
    command.sequence = ++sequence_;
    command.kind = kind;
    command.yaw = yaw_;
    return command;
  }
  /// To the server of the avatar, or to `region`; who joins comes to that spawn point.
  void act(PlayerCommand::Kind kind, std::optional<int> region = {}, std::uint16_t spawn = 0) {
    PlayerCommand command = next(kind);
    command.spawn = spawn;
    cluster_.command(command, region);
  }

 private:
  RegionCluster& cluster_;
  PlayerId player_;
  float yaw_;
  std::uint32_t sequence_ = 0;
};

}  // namespace aureole::testing
