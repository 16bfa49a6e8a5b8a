// What the servers of one world know and strangers do not: by it they tell each other apart.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string_view>

#include "server/base/result.h"

namespace aureole {

/// A key made of whatever text an operator keeps in a file. It never leaves its server: links prove
/// that they know it (server/net/links/handshake.h).
class Secret {
 public:
  /// Shorter texts can be guessed from one handshake that somebody has listened to.
  static constexpr std::size_t min_characters = 16;
  static constexpr std::size_t max_characters = 4096;
  static constexpr std::size_t mac_bytes = 32;
  using Mac = std::array<std::byte, mac_bytes>;

  /// The text of a file, line ends at its end left out. An Error says which file, and what is wrong
  /// with it.
  static Result<Secret> read(const std::filesystem::path& file);
  /// An Error if the text is too short or too long.
  static Result<Secret> from_text(std::string_view text);

  /// HMAC-SHA-512-256 of the parts, one after the other. Whoever joins parts whose lengths are not
  /// fixed must see to it that no two lists of parts join to the same bytes.
  Mac mac(std::initializer_list<std::span<const std::byte>> parts) const;
  /// Takes as long whether they are alike or not.
  static bool are_same(const Mac& a, const Mac& b);

 private:
  Secret() = default;
  std::array<unsigned char, 32> key_{};
};

/// Never the same twice.
std::array<std::byte, 32> random_nonce();

/// A new secret as text, for those who have none to bring: 64 hexadecimal digits.
std::string random_secret();

}  // namespace aureole
