// The regions of a world: do they tile the plane, are they wide enough, how is an extent split?
// extent split into n of them?
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/worlds/world.h"

namespace aureole {

inline constexpr int regions_max = 64;

PartitionMap partition_of(const WorldDefinition& world);

/// A sentence naming the first overlap or gap, nothing if every point of the plane is in exactly
/// one region. Exact: the sides cut the plane into cells, and each cell, the infinite outer ones
/// too, is counted.
std::optional<std::string> tiling_mistake(const std::vector<RegionDefinition>& regions);

/// The smaller of a region's extents in x and z (unit: m); infinite sides are wide.
double width_m(const Rectangle& area);

/// The index of the first region narrower than `needed_m`.
std::optional<std::size_t> too_narrow(const std::vector<RegionDefinition>& regions,
                                      double needed_m);

/// Splits a finite extent into `count` regions r0, r1 … row by row from the lowest z: 4 and 9 as a
/// grid, others as columns. The outermost sides reach to infinity; each cell of the extent must be
/// at least `needed_m` wide (outer ones too, although they reach on). 1 … regions_max.
std::vector<RegionDefinition> split_extent(const Rectangle& extent, int count);
/// Width of the cells that split_extent would cut (unit: m); infinite for 1.
double split_width_m(const Rectangle& extent, int count);
/// The largest count whose cells are at least `needed_m` wide; 1 always fits.
int largest_split(const Rectangle& extent, double needed_m);

}  // namespace aureole
