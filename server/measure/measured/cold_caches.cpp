// A walk through more memory than caches hold.
#include "server/measure/measured/cold_caches.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace aureole {
namespace {

constexpr std::size_t unknown_bytes = 32u << 20, largest_bytes = 512u << 20;

/// Of the largest cache that this core has or shares; the kernel knows it ("32768K"). What the
/// processor says by itself is that of all cores on it, of which a process uses one part.
std::size_t last_cache_bytes() {
  std::size_t most = 0;
  for (int level = 0; level < 8; ++level) {
    std::ifstream file(fmt::format("/sys/devices/system/cpu/cpu0/cache/index{}/size", level));
    std::size_t size = 0;
    char unit = ' ';
    if (!(file >> size >> unit) || size > largest_bytes) continue;
    most = std::max(most, unit == 'M' ? size << 20 : unit == 'K' ? size << 10 : size);
  }
  return most == 0 ? unknown_bytes : std::min(most, largest_bytes);
}

}  // namespace

ColdCaches::ColdCaches() : memory_(2 * last_cache_bytes() / sizeof(Line)) {}

void ColdCaches::chill() {
  // Read only: what is written would have to be written back, for most of the time.
  std::uint64_t sum = 0;
  for (const Line& line : memory_) sum += line.count;
  sum_ = sum;
}

}  // namespace aureole
