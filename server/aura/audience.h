// To whom an aura is told: Algorithms 3 to 6 of the paper and its corner case.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "server/aura/partition/partition_map.h"
#include "server/base/ids.h"
#include "server/base/world_position.h"

namespace aureole {

/// A set of regions, one bit each.
class RegionSet {
 public:
  /// Regions that a world can have at most.
  static constexpr std::size_t capacity = 64;

  void add(RegionId region) { bits_ |= bit(region); }
  void remove(RegionId region) { bits_ &= ~bit(region); }
  bool contains(RegionId region) const { return (bits_ & bit(region)) != 0; }
  bool empty() const { return bits_ == 0; }
  bool holds_several() const { return std::popcount(bits_) > 1; }
  void add(RegionSet others) { bits_ |= others.bits_; }
  /// The one with the lowest number. The set must not be empty.
  RegionId lowest() const;
  /// Ascending.
  std::vector<RegionId> regions() const;
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::uint64_t rest = bits_; rest != 0; rest &= rest - 1)
      visit(RegionId{static_cast<std::uint16_t>(std::countr_zero(rest))});
  }
  friend bool operator==(RegionSet, RegionSet) = default;

 private:
  static constexpr std::uint64_t bit(RegionId region) { return std::uint64_t{1} << region.value; }
  std::uint64_t bits_ = 0;
};

/// Nobody while the aura lies inside its host's region. An aura that intersects a boundary is told
/// to all servers at that boundary: those whose regions it reaches, and the neighbours of these,
/// which may host something there (Algorithm 6; section 3.6, the corner case). One that reaches a
/// region beyond the host's neighbours is told to everybody: whoever else hosts as far from home
/// would otherwise neither hear of it nor be heard. Never to `host` itself.
/// \param reach_m  the aura's radius, or half the larger edge of its box in x and z.
RegionSet audience_of(const PartitionMap& map, RegionId host, const WorldPosition& centre,
                      double reach_m);

/// Only those whose regions an aura at home reaches: enough where whoever has something abroad
/// tells audience_of() it, and is told in return of what is near to it. One that reaches a region
/// beyond the host's neighbours is told to everybody. Never to `host` itself.
RegionSet audience_at_home(const PartitionMap& map, RegionId host, const WorldPosition& centre,
                           double reach_m);

}  // namespace aureole
