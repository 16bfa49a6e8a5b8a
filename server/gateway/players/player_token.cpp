// Tokens, player ids and session numbers.
#include "server/gateway/players/player_token.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <random>

#include "server/base/hash.h"

namespace aureole {

std::string make_player_token() {
  std::random_device entropy;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", static_cast<std::uint32_t>(entropy()));
  return token;
}

PlayerId player_of_token(std::string_view token) {
  const std::uint64_t hash = Hasher().text(token).value();
  const auto folded = static_cast<std::uint32_t>(hash ^ (hash >> 32));
  return PlayerId{folded == 0 ? 1 : folded};
}

std::uint32_t next_session(std::int64_t unix_ms, std::uint32_t newest_known) {
  constexpr std::int64_t epoch_ms = 1'735'689'600'000;  // 2025-01-01T00:00:00Z
  constexpr std::int64_t largest = std::numeric_limits<std::uint32_t>::max();
  const std::int64_t by_clock = std::clamp<std::int64_t>((unix_ms - epoch_ms) / 250, 1, largest);
  const std::int64_t by_order = std::min<std::int64_t>(std::int64_t{newest_known} + 1, largest);
  return static_cast<std::uint32_t>(std::max(by_clock, by_order));
}

}  // namespace aureole
