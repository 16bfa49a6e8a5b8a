// FNV-1a, 64 bit: for state hashes and the world hash, where speed matters less than being the same
// everywhere.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace aureole {

/// Feeds values in order; the result depends on every byte and its place.
/// Source: Fowler, Noll, Vo; http://www.isthe.com/chongo/tech/comp/fnv/
class Hasher {
 public:
  Hasher& bytes(std::span<const std::byte> data) {
    for (std::byte b : data)
      state_ = (state_ ^ std::to_integer<std::uint64_t>(b)) * 0x100'0000'01b3u;
    return *this;
  }
  Hasher& text(std::string_view s) { return bytes(std::as_bytes(std::span(s))); }
  template <class T>
  requires std::is_arithmetic_v<T> Hasher& add(T value) {
    return bytes(std::as_bytes(std::span(&value, 1)));
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf2'9ce4'8422'2325u;
};

}  // namespace aureole
