// A walk through more memory than caches hold.
#include "server/measure/cold_caches.h"

#include <unistd.h>

#include <algorithm>

namespace aureole {
namespace {

constexpr long unknown_bytes = 32L << 20, largest_bytes = 512L << 20;

std::size_t last_cache_bytes() {
  long bytes = 0;
#ifdef _SC_LEVEL3_CACHE_SIZE
  bytes = std::max(sysconf(_SC_LEVEL2_CACHE_SIZE), sysconf(_SC_LEVEL3_CACHE_SIZE));
#endif
  return static_cast<std::size_t>(bytes > 0 ? std::min(bytes, largest_bytes) : unknown_bytes);
}

}  // namespace

ColdCaches::ColdCaches() : memory_(2 * last_cache_bytes() / sizeof(Line)) {}

void ColdCaches::chill() {
  // Written, so that the lines are this core's own.
  for (Line& line : memory_) ++line.count;
}

}  // namespace aureole
