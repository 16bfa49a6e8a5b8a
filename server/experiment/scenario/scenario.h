// What a seed stands for: a world cut into regions, and what happens at its boundaries.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/worlds/world.h"

namespace aureole {

struct ScenarioOptions {
  /// One of layout_names(), or a world file.
  std::string layout = "corner4";
  MigrationMode mode = MigrationMode::adaptive;
  std::uint64_t seed = 1;
  double seconds = 20;
  int bodies = 300;  ///< Of built-in layouts; a file's world comes as it is.
  std::optional<double> latency_tolerance_ms = {};  ///< Instead of the world's.
};

struct Scenario {
  WorldDefinition world;
  std::string kind;  ///< "pour", "flights", "rows", "players" or "file".
  int players = 0;   ///< How many join.
};

/// Half of the seeds pour bodies onto boundaries and corners until heaps lie across them; the
/// others fly across, stand on boundaries asleep until they are struck, or are played.
/// Everything is derived from the options. Errors: those of load_world.
Result<Scenario> make_scenario(const ScenarioOptions& options);

bool is_layout(std::string_view name);
/// All of them: "column2, column4 …".
std::string layout_names();
/// Equal squares around the origin, row by row; the outermost ones have no end.
std::vector<RegionDefinition> grid_of_regions(int columns, int rows, double region_m);
/// Fig. 6: two squares above, one of both widths below; they meet at a T.
std::vector<RegionDefinition> three_at_a_corner(double region_m);
/// The empty world of a built-in layout (is_layout()): ground, prototypes, regions of 32 m, one
/// spawn point.
WorldDefinition layout_world(std::string_view name);

/// Prototypes of the built-in layouts; the first three are those of the paper's workload.
inline constexpr PrototypeId sphere_prototype{0}, cuboid_prototype{1}, capsule_prototype{2},
    domino_prototype{3}, brick_prototype{4}, avatar_prototype_id{5};

/// A point where boundaries meet (a corner), or one on a boundary.
struct BoundarySpot {
  double x = 0, z = 0;
  bool corner = false;
};
/// Corners first, then the middles of all boundaries; infinite ones are taken up to `reach_m`.
std::vector<BoundarySpot> boundary_spots(const PartitionMap& map, double reach_m);

/// Adds a body at rest or moving; returns its id.
BodyId put_body(WorldDefinition& world, PrototypeId prototype, WorldPosition at,
                Eigen::Vector3f velocity = {0, 0, 0}, Activation activation = Activation::awake);

}  // namespace aureole
