// Bringing memory nearer before it is needed.
#pragma once

#include <cstddef>

namespace aureole {

/// What the processor fetches at once (bytes). Were it another size, fetching ahead would help
/// less, and nothing else.
inline constexpr std::size_t cache_line = 64;

/// Begins to bring the line at `p` into the cache. `p` may be anything, also an address of nothing.
inline void prefetch(const void* p) {
  __builtin_prefetch(p);
}

/// The same for all lines of the object or array at `p` of `size` bytes, at least one: what is asked
/// for together is waited for once.
inline void prefetch(const void* p, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(p);
  for (std::size_t at = 0; at < size; at += cache_line) prefetch(first + at);
  prefetch(first + size - 1);
}

}  // namespace aureole
