// Who a player is: a secret token that only the browser keeps, and the id that all servers know.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/ids.h"

namespace aureole {

/// 128 random bits from the operating system as 32 lower-case hex digits.
std::string make_player_token();

/// The id that belongs to a token: a hash, so that a gateway that has just started knows the player
/// again without having kept anything. Never 0.
PlayerId player_of_token(std::string_view token);

/// Number of a new session of a player: quarters of a second since 2025-01-01 UTC (lasts until
/// 2059), so that it grows over restarts of the gateway and from one gateway to the next; always
/// greater than `newest_known`, whatever the wall clock (`unix_ms`) says.
std::uint32_t next_session(std::int64_t unix_ms, std::uint32_t newest_known);

}  // namespace aureole
