// The built-in layouts: small regions with the boundaries of the paper's experiments.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "server/base/check.h"
#include "server/experiment/scenario/scenario.h"

namespace aureole {
namespace {

/// Of one region (m): far wider than four aura radii, small enough that bodies get about.
constexpr double layout_region_m = 32;

struct Layout {
  std::string_view name;
  int columns = 0, rows = 0;
  bool tee = false;  ///< Three that meet at a T.
};
/// The first and the last of six columns are far apart (signs_of_life.h).
constexpr Layout layouts[] = {{"column2", 2, 1},       {"column4", 4, 1}, {"column6", 6, 1},
                              {"corner3", 0, 0, true}, {"corner4", 2, 2}, {"corner9", 3, 3}};

const Layout* layout_named(std::string_view name) {
  const auto* const found = std::find_if(std::begin(layouts), std::end(layouts),
                                         [&](const Layout& layout) { return layout.name == name; });
  return found == std::end(layouts) ? nullptr : found;
}

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
  return layout_named(name) != nullptr;
}

std::string layout_names() {
  std::string names;
  for (const Layout& layout : layouts)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", layout.name);
  return names;
}

WorldDefinition layout_world(std::string_view name) {
  WorldDefinition world;
  world.name = std::string(name);
  const Layout* const layout = layout_named(name);
  AUREOLE_CHECK(layout != nullptr, "a layout's name is looked at before");
  world.regions = layout->tee ? three_at_a_corner(layout_region_m)
                              : grid_of_regions(layout->columns, layout->rows, layout_region_m);
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

std::vector<BoundarySpot> boundary_spots(const PartitionMap& map, double reach_m) {
  std::set<std::pair<double, double>> corners;
  std::vector<BoundarySpot> middles;
  for (const BoundarySegment& s : map.boundaries()) {
    for (const auto& [x, z] : {std::pair(s.from_x, s.from_z), std::pair(s.to_x, s.to_z)})
      if (std::isfinite(x) && std::isfinite(z)) corners.insert({x, z});
    const auto within = [&](double v) { return std::isfinite(v) ? v : std::copysign(reach_m, v); };
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
