// Bringing memory nearer before it is needed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace aureole {

/// What the processor fetches at once (bytes). Were it another size, fetching ahead would help
/// less, and nothing else.
inline constexpr std::size_t cache_line = 64;

/// Begins to bring the line at `p` into the cache. `p` may be anything, also an address of nothing.
inline void prefetch(const void* p) {
  __builtin_prefetch(p);
  // Says that this does something: else GCC leaves out calls of functions that only fetch.
  asm volatile("" : : "r"(p));
}

/// The same for all lines of the object or array at `p` of `size` bytes, at least one: what is
/// asked for together is waited for once.
inline void prefetch(const void* p, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(p);
  for (std::size_t at = 0; at < size; at += cache_line) prefetch(first + at);
  prefetch(first + size - 1);
}

/// The same for the first lines of what lies side by side and will be gone through from its
/// beginning: the rest the processor fetches by itself as soon as it has seen where the walk goes.
template <class List>
void prefetch_beginning(const List& list, std::size_t most = 8 * cache_line) {
  if (!list.empty()) prefetch(&*list.begin(), std::min(list.size() * sizeof(*list.begin()), most));
}

/// What lies behind pointers is brought nearer step by step: each needs what the one before has
/// brought.
enum class FetchStep : std::uint8_t {
  object,  ///< What has a list,
  list,    ///< that list,
  listed,  ///< and what is on it.
};
inline constexpr std::array fetch_steps{FetchStep::object, FetchStep::list, FetchStep::listed};
/// How many places of a queue before its turn something is to be fetched, one step at each place:
/// the last one right before it.
constexpr std::size_t places_ahead(FetchStep step) {
  return fetch_steps.size() - static_cast<std::size_t>(step);
}

}  // namespace aureole
