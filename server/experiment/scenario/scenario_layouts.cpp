// The built-in layouts: small regions with the boundaries of the paper's experiments.
#include <algorithm>
#include <cmath>
#include <set>

#include "server/experiment/scenario/scenario.h"

namespace aureole {
namespace {

/// Of one region (m): far wider than four aura radii, small enough that bodies get about.
constexpr double layout_region_m = 32;

Prototype prototype(std::string name, Shape shape, float mass_kg) {
  Prototype p;
  p.name = std::move(name);
  p.body.shape = std::move(shape);
  p.body.mass_kg = mass_kg;
  return p;
}

}  // namespace

std::vector<RegionDefinition> grid_of_regions(int columns, int rows, double region_m) {
  std::vector<RegionDefinition> regions;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      RegionDefinition region;
      region.name = "r" + std::to_string(regions.size());
      if (column > 0) region.area.min_x = (column - columns / 2.0) * region_m;
      if (column + 1 < columns) region.area.max_x = (column + 1 - columns / 2.0) * region_m;
      if (row > 0) region.area.min_z = (row - rows / 2.0) * region_m;
      if (row + 1 < rows) region.area.max_z = (row + 1 - rows / 2.0) * region_m;
      regions.push_back(region);
    }
  }
  return regions;
}

/// Fig. 6: two above, one wide below; they meet at a T.
std::vector<RegionDefinition> three_at_a_corner(double region_m) {
  auto regions = grid_of_regions(2, 2, region_m);
  regions.pop_back();
  regions[2].area.max_x = std::numeric_limits<double>::infinity();
  return regions;
}

bool is_layout(std::string_view name) {
  return name == "column2" || name == "column4" || name == "corner3" || name == "corner4" ||
         name == "corner9";
}

WorldDefinition layout_world(std::string_view name) {
  WorldDefinition world;
  world.name = std::string(name);
  if (name == "column2") world.regions = grid_of_regions(2, 1, layout_region_m);
  if (name == "column4") world.regions = grid_of_regions(4, 1, layout_region_m);
  if (name == "corner3") world.regions = three_at_a_corner(layout_region_m);
  if (name == "corner4") world.regions = grid_of_regions(2, 2, layout_region_m);
  if (name == "corner9") world.regions = grid_of_regions(3, 3, layout_region_m);
  // A heap of 300 comes to rest within 18 s of a run that pours for 7 s (half a minute with the
  // speeds that worlds have by default, measured), so that the end of a run can be judged.
  world.physics.sleep_linear_speed = 0.4f;
  world.physics.sleep_angular_speed = 0.8f;
  world.bounds = {{-150, -20, -150}, {150, 100, 150}};
  world.prototypes = {prototype("sphere", SphereShape{0.3f}, 10),
                      prototype("cuboid", BoxShape{{0.15f, 0.15f, 0.5f}}, 10),
                      prototype("capsule", CapsuleShape{0.3f, 2}, 10),
                      prototype("domino", BoxShape{{0.06f, 0.4f, 0.2f}}, 10),
                      prototype("brick", BoxShape{{0.2f, 0.15f, 0.3f}}, 10),
                      prototype("avatar", CapsuleShape{0.35f, 1.8f}, 80)};
  Prototype& avatar = world.prototypes[avatar_prototype_id.value];
  avatar.body.upright = true;
  avatar.body.friction = 0;
  world.avatar = avatar_prototype_id;
  WorldStatic ground;
  ground.name = "ground";
  world.statics.push_back(ground);
  world.spawn_points.push_back({{3, 0.95, 3}, 0});
  for (auto& item : world.throwables) item = {"sphere", sphere_prototype, 20};
  world.hash = 1;
  return world;
}

PartitionMap partition_of(const WorldDefinition& world) {
  std::vector<Rectangle> areas;
  for (const auto& region : world.regions) areas.push_back(region.area);
  return PartitionMap(std::move(areas));
}

std::vector<BoundarySpot> boundary_spots(const PartitionMap& map, double reach_m) {
  std::set<std::pair<double, double>> corners;
  std::vector<BoundarySpot> middles;
  for (const BoundarySegment& s : map.boundaries()) {
    for (const auto& [x, z] : {std::pair(s.from_x, s.from_z), std::pair(s.to_x, s.to_z)})
      if (std::isfinite(x) && std::isfinite(z)) corners.insert({x, z});
    const auto within = [&](double v) { return std::clamp(v, -reach_m, reach_m); };
    middles.push_back(
        {(within(s.from_x) + within(s.to_x)) / 2, (within(s.from_z) + within(s.to_z)) / 2, false});
  }
  std::vector<BoundarySpot> spots;
  for (const auto& [x, z] : corners) spots.push_back({x, z, true});
  spots.insert(spots.end(), middles.begin(), middles.end());
  return spots;
}

BodyId put_body(WorldDefinition& world, PrototypeId prototype, WorldPosition at,
                Eigen::Vector3f velocity, Activation activation) {
  WorldBody body;
  body.prototype = prototype;
  body.state.position = at;
  body.state.linear_velocity = velocity;
  body.state.activation = activation;
  world.bodies.push_back(body);
  return BodyId::world(static_cast<std::uint32_t>(world.bodies.size() - 1));
}

}  // namespace aureole
