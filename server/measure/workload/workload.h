// The workload of the paper's experiments (section 5): where bodies come into which regions.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/result.h"
#include "server/worlds/world.h"

namespace aureole {

/// Of one region (m). The paper gives none; its volumes are so long along a boundary.
inline constexpr double workload_region_m = 150;

struct WorkloadOptions {
  /// "column" (Fig. 4), "corner" (Fig. 6), or "grid": n × n regions of the same density.
  std::string layout = "column";
  int servers = 2;          ///< column: 1 … 10; corner: 1, 3, 4 or 9; grid: 4, 9, 16 … 64.
  double seconds = 60;      ///< Bodies are injected for so long.
  double rate_per_s = 160;  ///< All injectors together; of a grid: those of four regions.
  std::uint64_t seed = 1;
  AuraTolerances tolerances;
};

/// All injectors together: a grid's grow with the number of its regions.
double total_rate_per_s(const WorkloadOptions& options);

/// Half of the bodies come beside boundaries, in 20×20×150 m on either side of each piece of
/// boundary, 12 m from it and 15 m up; half in 20×20×20 m at the regions' centres, as high. One
/// region has no boundary: its first half comes 12 m from its right-hand edge, where two would have
/// one. In a grid each region gets the same number of bodies beside its boundaries, however many
/// sides these have, so that all servers have the same to do, few or many. Infinite regions count
/// as far as they would reach if they were 150 m. Errors: no such layout, or not for so many
/// servers.
Result<WorldDefinition> workload_world(const WorkloadOptions& options);

/// The same world, not cut: one region holds everything.
WorldDefinition in_one_region(WorldDefinition world);

}  // namespace aureole
