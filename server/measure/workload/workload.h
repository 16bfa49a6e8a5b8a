// The workload of the paper's experiments (section 5): where bodies come into which regions.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/result.h"
#include "server/worlds/world.h"

namespace aureole {

/// How long the volumes beside boundaries are (m), as the paper has it.
inline constexpr double boundary_volume_m = 150;

struct WorkloadOptions {
  /// "column" (Fig. 4), "corner" (Fig. 6), or "grid": n × n regions of the same density.
  std::string layout = "column";
  int servers = 2;          ///< column: 1 … 10; corner: 1, 3, 4 or 9; grid: 4, 9, 16 … 64.
  double seconds = 60;      ///< Bodies are injected for so long.
  double rate_per_s = 160;  ///< All injectors together; of a grid: those of four regions.
  std::uint64_t seed = 1;
  /// Edge of a region (m). The paper gives none; with this one, volumes beside boundaries go from
  /// one corner to the next.
  double region_m = boundary_volume_m;
  AuraTolerances tolerances;
};

/// All injectors together: a grid's grow with the number of its regions.
double total_rate_per_s(const WorkloadOptions& options);

/// Half of the bodies come beside boundaries, in 20×20×150 m on either side of the middle of each
/// piece of boundary (less where that is shorter), 12 m from it and 15 m up; half in 20×20×20 m at
/// the regions' centres, as high. One region has no boundary: its first half comes 12 m from its
/// right-hand edge, where two would have one. In a grid each region gets the same number of bodies
/// beside its boundaries, however many sides these have, so that all servers have the same to do,
/// few or many. Infinite regions count as far as they would reach if they were `region_m` long.
/// Errors: no such layout, or not for so many servers.
Result<WorldDefinition> workload_world(const WorkloadOptions& options);

/// The same world, not cut: one region holds everything.
WorldDefinition in_one_region(WorldDefinition world);

}  // namespace aureole
