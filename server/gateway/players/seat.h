// What the hub keeps for one connection; shared by the hub's source files only.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "server/gateway/players/player_hub.h"

namespace aureole {

struct PlayerHub::Seat {
  SeatId id = 0;
  std::shared_ptr<Connection> connection;
  std::int64_t since_us = 0;  ///< Connected, then asked to join (local time).
  bool closing = false;
  std::optional<JoinMessage> asked;  ///< Until the regions can answer.
  bool new_player = false;
  std::int64_t word_due_us = 0;  ///< When one who waits is told again what for (local time).
  std::shared_ptr<PlayerSession> session;
  std::shared_ptr<PlayerView> view;
  std::string notice;
  double actions_left = 0;         ///< Token bucket; see actions_per_s.
  std::int64_t actions_at_us = 0;  ///< When the bucket was last filled.
  std::optional<std::int64_t> avatar_missing_since_us;
};

}  // namespace aureole
