// Regions by short names, and maps in which they meet at corners.
#pragma once

#include <initializer_list>
#include <limits>
#include <vector>

#include "server/aura/partition/partition_map.h"

namespace aureole::aura_maps {

inline constexpr double inf = std::numeric_limits<double>::infinity();

inline RegionId r(int i) {
  return RegionId{static_cast<std::uint16_t>(i)};
}

inline std::vector<RegionId> regions(std::initializer_list<int> list) {
  std::vector<RegionId> all;
  for (int i : list) all.push_back(r(i));
  return all;
}

inline PartitionMap quarters() {
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, 0, inf}, {0, 0, inf, inf}});
}

/// Two above, one wide below.
inline PartitionMap t_shape() {
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, inf, inf}});
}

}  // namespace aureole::aura_maps
