// Regions, the volumes beside their boundaries and at their centres, and injectors for them.
#include "server/measure/workload/workload.h"

#include <algorithm>
#include <cmath>

#include "server/experiment/random.h"
#include "server/experiment/scenario/scenario.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

constexpr double off_boundary_m = 12, height_m = 15, half_width_m = 10;

/// 0 if it is no square.
int edge_of_grid(int servers) {
  const int edge = static_cast<int>(std::lround(std::sqrt(servers)));
  return edge * edge == servers ? edge : 0;
}

Result<std::vector<RegionDefinition>> regions_of(const WorkloadOptions& o) {
  const double m = o.region_m;
  if (o.layout == "column") {
    if (o.servers < 1 || o.servers > 10)
      return Error::format("columns are measured on 1 to 10 servers, not on {}", o.servers);
    return grid_of_regions(o.servers, 1, m);
  }
  if (o.layout == "grid") {
    const int edge = edge_of_grid(o.servers);
    if (edge < 2 || edge > 8)
      return Error::format("grids are measured on 4, 9, 16, 25, 36, 49 or 64 servers, not on {}",
                           o.servers);
    return grid_of_regions(edge, edge, m);
  }
  if (o.layout != "corner")
    return Error::format("there is no layout {}; expected column, corner or grid", o.layout);
  switch (o.servers) {
    case 1:
      return grid_of_regions(1, 1, m);
    case 3:
      return three_at_a_corner(m);
    case 4:
      return grid_of_regions(2, 2, m);
    case 9:
      return grid_of_regions(3, 3, m);
    default:
      return Error::format("corners are measured on 1, 3, 4 or 9 servers, not on {}", o.servers);
  }
}

/// How far the whole of the regions reaches from the origin, along x and z.
struct Extent {
  double x, z;
};

Extent extent_of(const WorkloadOptions& o) {
  const double half = o.region_m / 2;
  if (o.layout == "column") return {o.servers * half, half};
  if (o.layout == "grid") return {edge_of_grid(o.servers) * half, edge_of_grid(o.servers) * half};
  const double edge = o.servers == 1 ? half : o.servers == 9 ? 3 * half : 2 * half;
  return {edge, edge};
}

Box3 volume_around(double x, double z, double half_x, double half_z) {
  return {{x - half_x, height_m - half_width_m, z - half_z},
          {x + half_x, height_m + half_width_m, z + half_z}};
}

/// Where bodies come, and how many of all that come beside boundaries or at centres.
struct Source {
  Box3 volume;
  double share;
};

std::vector<Source> volumes_at_boundaries(const PartitionMap& map, Extent extent,
                                          bool each_region_alike) {
  std::vector<Source> volumes;
  std::vector<double> sides(map.size(), 0);
  for (const BoundarySegment& s : map.boundaries())
    for (const RegionId region : {s.first, s.second}) ++sides[region.value];
  const double pieces = 2 * static_cast<double>(map.boundaries().size());
  for (const BoundarySegment& s : map.boundaries()) {
    const bool along_z = s.from_x == s.to_x;
    const double reach = along_z ? extent.z : extent.x;
    const double from = std::max(along_z ? s.from_z : s.from_x, -reach);
    const double to = std::min(along_z ? s.to_z : s.to_x, reach);
    const double middle = (from + to) / 2, half = std::min(to - from, boundary_volume_m) / 2;
    for (const double side : {-off_boundary_m, off_boundary_m}) {
      const double x = along_z ? s.from_x + side : middle, z = along_z ? middle : s.from_z + side;
      const double of_region =
          1 / (sides[map.region_at(x, z).value] * static_cast<double>(map.size()));
      volumes.push_back({along_z ? volume_around(x, z, half_width_m, half)
                                 : volume_around(x, z, half, half_width_m),
                         each_region_alike ? of_region : 1 / pieces});
    }
  }
  if (volumes.empty())
    volumes.push_back({volume_around(extent.x - off_boundary_m, 0, half_width_m,
                                     std::min(extent.z, boundary_volume_m / 2)),
                       1});
  return volumes;
}

std::vector<Source> volumes_at_centres(const PartitionMap& map, Extent extent) {
  std::vector<Source> volumes;
  for (std::uint16_t r = 0; r < map.size(); ++r) {
    const Rectangle& area = map.area(RegionId{r});
    const double x = std::max(area.min_x, -extent.x) + std::min(area.max_x, extent.x);
    const double z = std::max(area.min_z, -extent.z) + std::min(area.max_z, extent.z);
    volumes.push_back({volume_around(x / 2, z / 2, half_width_m, half_width_m),
                       1 / static_cast<double>(map.size())});
  }
  return volumes;
}

void inject(WorldDefinition& world, const WorkloadOptions& o, const std::vector<Source>& volumes,
            const char* name) {
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    Injector& made = world.injectors.emplace_back();
    made.name = name + std::to_string(i);
    made.rate_per_s = total_rate_per_s(o) / 2 * volumes[i].share;
    made.volume = volumes[i].volume;
    made.velocity_min = {-10, -10, -10};
    made.velocity_max = {10, 0, 10};
    made.mix = {{sphere_prototype, 1}, {cuboid_prototype, 1}, {capsule_prototype, 1}};
    // As many bits as a number in a world file holds.
    made.seed = Random(o.seed, 1000 + world.injectors.size()).bits() >> 11;
    // One after the other: if all made theirs in the same tick, that tick's frame would stick out.
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(volumes.size());
    made.start_s = -share / made.rate_per_s;
    made.duration_s = o.seconds - made.start_s;
  }
}

}  // namespace

double total_rate_per_s(const WorkloadOptions& o) {
  return o.layout == "grid" ? o.rate_per_s * o.servers / 4 : o.rate_per_s;
}

Result<WorldDefinition> workload_world(const WorkloadOptions& options) {
  auto regions = regions_of(options);
  if (!regions) return regions.error();
  // The shapes are the built-in layouts'; the speeds to sleep at are those of any world.
  WorldDefinition world = layout_world("corner4");
  world.name = options.layout + std::to_string(options.servers);
  world.physics = {};
  world.tolerances = options.tolerances;
  world.regions = std::move(*regions);
  const Extent extent = extent_of(options);
  const double far = std::max(extent.x, extent.z) + 1000;
  world.bounds = {{-far, -20, -far}, {far, 200, far}};
  world.max_bodies = std::max(
      world.max_bodies,
      static_cast<std::uint32_t>(std::ceil(total_rate_per_s(options) * options.seconds)) + 100);
  const PartitionMap map = partition_of(world);
  inject(world, options, volumes_at_boundaries(map, extent, options.layout == "grid"), "boundary ");
  inject(world, options, volumes_at_centres(map, extent), "centre ");
  return world;
}

WorldDefinition in_one_region(WorldDefinition world) {
  world.regions.resize(1);
  world.regions.front().area = {};
  return world;
}

}  // namespace aureole
