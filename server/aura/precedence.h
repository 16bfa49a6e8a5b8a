// Who goes before whom.
#pragma once

#include <cstdint>
#include <span>

#include "server/aura/audience.h"
#include "server/aura/partition/partition_map.h"

namespace aureole {

/// An order of all servers, the same for all of them at one tick: of two servers the first is the
/// arbiter of what meets, and where three meet all goes to the first one. Who has less to do goes
/// first, so that what nobody can share out by place goes to who has room for it. Before that goes
/// who has fewer neighbours: it meets others at fewer places, and its order never changes.
///
/// A server's load travels as a level, and is in force from a tick on that was told long before
/// (load_levels.h): two servers with different orders would each ask the other one to come.
struct Precedence {
  std::span<const std::uint16_t> levels{};  ///< By region; empty: all have equally much to do.
  /// How many neighbours each region has, by region; empty: all have equally many.
  std::span<const std::uint16_t> neighbours{};

  /// Fewer neighbours; of two alike who has less to do; of two alike again the lower number.
  bool before(RegionId a, RegionId b) const {
    if (!neighbours.empty() && neighbours[a.value] != neighbours[b.value])
      return neighbours[a.value] < neighbours[b.value];
    if (!levels.empty() && levels[a.value] != levels[b.value])
      return levels[a.value] < levels[b.value];
    return a < b;
  }
  RegionId first(RegionId a, RegionId b) const { return before(b, a) ? b : a; }
  /// Of a set that must not be empty.
  RegionId first(RegionSet servers) const {
    RegionId first_of_all = servers.lowest();
    servers.for_each([&](RegionId region) { first_of_all = first(first_of_all, region); });
    return first_of_all;
  }
};

}  // namespace aureole
