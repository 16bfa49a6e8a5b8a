// People in virtual time: they walk across boundaries, throw, blast, grab and carry, by a script
// from the seed.
#pragma once

#include <map>
#include <vector>

#include "server/experiment/random.h"
#include "server/experiment/simulated/simulated_gateway.h"
#include "server/gateway/players/command_stream.h"

namespace aureole {

/// Commands go through the production CommandStream and the simulated gateway to whoever owns the
/// avatar according to the store; the players themselves outlive a crash of the gateway, as
/// browsers do, and join again.
class SimulatedPlayers {
 public:
  static constexpr Micros interval_us = 50'000;

  SimulatedPlayers(const WorldDefinition& world, int count, std::uint64_t seed);

  Micros wakes_at() const { return players_.empty() ? never : wakes_at_us_; }
  /// `active`: they still do things; later they stand still, so that all can come to rest.
  void wake(SimulatedNetwork& network, SimulatedGateway& gateway, Micros now, bool active);
  /// When something sudden was last commanded; -1: never.
  Micros last_deed_us() const { return last_deed_us_; }

 private:
  struct Player {
    PlayerId id;
    std::uint16_t spawn = 0;
    CommandStream stream;
    Random random;
    float yaw = 0;
    std::uint8_t keys = 0;
    Micros joins_at_us = 0;
    Micros next_turn_us = 0, next_deed_us = 0;
    Incarnation gateway{};  ///< Through which it joined.
    std::uint32_t session = 1;
  };
  void decide(Player& player, const SimulatedGateway& gateway, Micros now, bool active);
  void deliver(Player& player, SimulatedNetwork& network, SimulatedGateway& gateway, Micros now);
  BodyId something_near(const Player& player, const ReplicaStore& store, Micros now) const;

  const WorldDefinition& world_;
  std::vector<Player> players_;
  Micros wakes_at_us_ = 0;
  Micros last_deed_us_ = -1;
};

}  // namespace aureole
