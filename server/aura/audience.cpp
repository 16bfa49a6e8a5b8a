// Sets of regions, and who is in the audience of an aura.
#include "server/aura/audience.h"

#include <algorithm>
#include <bit>

#include "server/base/check.h"

namespace aureole {

RegionId RegionSet::lowest() const {
  AUREOLE_CHECK(bits_ != 0, "an empty set has no lowest region");
  return RegionId{static_cast<std::uint16_t>(std::countr_zero(bits_))};
}

std::vector<RegionId> RegionSet::regions() const {
  std::vector<RegionId> all;
  for_each([&](RegionId region) { all.push_back(region); });
  return all;
}

RegionSet audience_of(const PartitionMap& map, RegionId host, const WorldPosition& centre,
                      double reach_m) {
  AUREOLE_CHECK(map.size() <= RegionSet::capacity, "a world has at most 64 regions");
  const Rectangle& home = map.area(host);
  RegionSet told;
  const bool inside = centre.x - reach_m >= home.min_x && centre.x + reach_m < home.max_x &&
                      centre.z - reach_m >= home.min_z && centre.z + reach_m < home.max_z;
  if (inside) return told;
  const auto& near = map.neighbours(host);
  for (std::uint16_t k = 0; k < map.size(); ++k) {
    const RegionId reached{k};
    if (map.area(reached).distance(centre.x, centre.z) > reach_m) continue;
    told.add(reached);
    for (const RegionId around : map.neighbours(reached)) told.add(around);
    if (reached == host || std::binary_search(near.begin(), near.end(), reached)) continue;
    for (std::size_t i = 0; i < map.size(); ++i) told.add(RegionId{static_cast<std::uint16_t>(i)});
  }
  told.remove(host);
  return told;
}

RegionSet audience_at_home(const PartitionMap& map, RegionId host, const WorldPosition& centre,
                           double reach_m) {
  AUREOLE_CHECK(map.size() <= RegionSet::capacity, "a world has at most 64 regions");
  RegionSet told, others;
  const auto& near = map.neighbours(host);
  bool beyond_neighbours = false;
  for (std::uint16_t k = 0; k < map.size(); ++k) {
    const RegionId reached{k};
    if (reached == host) continue;
    others.add(reached);
    if (map.area(reached).distance(centre.x, centre.z) > reach_m) continue;
    told.add(reached);
    if (!std::binary_search(near.begin(), near.end(), reached)) beyond_neighbours = true;
  }
  return beyond_neighbours ? others : told;
}

}  // namespace aureole
