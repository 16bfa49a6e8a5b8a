// Exact checks of region rectangles by coordinate compression, and the splits of --regions.
#include "server/worlds/region_tiling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/check.h"

namespace aureole {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<double> sorted_sides(const std::vector<RegionDefinition>& regions, bool x) {
  std::vector<double> out{-inf, inf};
  for (const RegionDefinition& r : regions) {
    out.push_back(x ? r.area.min_x : r.area.min_z);
    out.push_back(x ? r.area.max_x : r.area.max_z);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// A point well inside an interval that may reach to infinity.
double inside(double min, double max) {
  if (std::isinf(min) && std::isinf(max)) return 0;
  if (std::isinf(min)) return max - 1;
  if (std::isinf(max)) return min + 1;
  return min + (max - min) / 2;
}

std::string overlap_sentence(const RegionDefinition& a, const RegionDefinition& b) {
  const double x = std::min(a.area.max_x, b.area.max_x) - std::max(a.area.min_x, b.area.min_x);
  const double z = std::min(a.area.max_z, b.area.max_z) - std::max(a.area.min_z, b.area.min_z);
  const std::string size = std::isinf(x * z) ? "an infinite area" : fmt::format("{:g} m²", x * z);
  return fmt::format(
      "regions \"{}\" and \"{}\" overlap by {} around x = {:g} m, z = {:g} m, expected each point "
      "in exactly one region",
      a.name, b.name, size,
      inside(std::max(a.area.min_x, b.area.min_x), std::min(a.area.max_x, b.area.max_x)),
      inside(std::max(a.area.min_z, b.area.min_z), std::min(a.area.max_z, b.area.max_z)));
}

std::pair<int, int> columns_and_rows(int count) {
  if (count == 4) return {2, 2};
  if (count == 9) return {3, 3};
  return {count, 1};
}

}  // namespace

PartitionMap partition_of(const WorldDefinition& world) {
  std::vector<Rectangle> areas;
  for (const RegionDefinition& region : world.regions) areas.push_back(region.area);
  return PartitionMap(std::move(areas));
}

std::optional<std::string> tiling_mistake(const std::vector<RegionDefinition>& regions) {
  const std::vector<double> xs = sorted_sides(regions, true), zs = sorted_sides(regions, false);
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t j = 0; j + 1 < zs.size(); ++j) {
      const RegionDefinition* owner = nullptr;
      for (const RegionDefinition& r : regions) {
        const bool covers = r.area.min_x <= xs[i] && xs[i + 1] <= r.area.max_x &&
                            r.area.min_z <= zs[j] && zs[j + 1] <= r.area.max_z;
        if (!covers) continue;
        if (owner) return overlap_sentence(*owner, r);
        owner = &r;
      }
      if (!owner) {
        return fmt::format(
            "no region covers the point x = {:g} m, z = {:g} m, expected each point in exactly one "
            "region (a side that is left out reaches to infinity)",
            inside(xs[i], xs[i + 1]), inside(zs[j], zs[j + 1]));
      }
    }
  }
  return {};
}

double width_m(const Rectangle& area) {
  return std::min(area.max_x - area.min_x, area.max_z - area.min_z);
}

std::optional<std::size_t> too_narrow(const std::vector<RegionDefinition>& regions,
                                      double needed_m) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (width_m(regions[i].area) < needed_m) return i;
  }
  return {};
}

std::vector<RegionDefinition> split_extent(const Rectangle& extent, int count) {
  AUREOLE_CHECK(count >= 1 && count <= regions_max, "a world has 1 to 64 regions");
  const auto [columns, rows] = columns_and_rows(count);
  const auto side = [](double min, double max, int i, int n) {
    return i == 0 ? -inf : i == n ? inf : min + (max - min) * i / n;
  };
  std::vector<RegionDefinition> out;
  for (int z = 0; z < rows; ++z) {
    for (int x = 0; x < columns; ++x) {
      const Rectangle area{side(extent.min_x, extent.max_x, x, columns),
                           side(extent.min_z, extent.max_z, z, rows),
                           side(extent.min_x, extent.max_x, x + 1, columns),
                           side(extent.min_z, extent.max_z, z + 1, rows)};
      out.push_back({fmt::format("r{}", out.size()), area});
    }
  }
  return out;
}

double split_width_m(const Rectangle& extent, int count) {
  const auto [columns, rows] = columns_and_rows(count);
  const double x = columns > 1 ? (extent.max_x - extent.min_x) / columns : inf;
  const double z = rows > 1 ? (extent.max_z - extent.min_z) / rows : inf;
  return std::min(x, z);
}

int largest_split(const Rectangle& extent, double needed_m) {
  for (int n = regions_max; n > 1; --n) {
    if (split_width_m(extent, n) >= needed_m) return n;
  }
  return 1;
}

}  // namespace aureole
