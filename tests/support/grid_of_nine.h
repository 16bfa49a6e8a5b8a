// A map of three by three regions.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "server/aura/partition/partition_map.h"

namespace aureole::testing {

/// 120 m each; the outermost go on for ever.
inline PartitionMap grid_of_nine() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double at[] = {-inf, -60, 60, inf};
  std::vector<Rectangle> areas;
  for (std::size_t z = 0; z < 3; ++z)
    for (std::size_t x = 0; x < 3; ++x) areas.push_back({at[x], at[z], at[x + 1], at[z + 1]});
  return PartitionMap(std::move(areas));
}

}  // namespace aureole::testing
