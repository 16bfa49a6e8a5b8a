// The grid of spheres: one counting sort by cell, then scans of the cells around a sphere.
#include "server/aura/shapes/sphere_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Cells for each sphere at most: in a wide and mostly empty world cells grow instead.
constexpr double cells_per_sphere = 4;

std::int64_t index_of(double metres, double cell_m, std::int64_t count) {
  const double cell = std::floor(metres / cell_m);
  if (!(cell > 0)) return 0;  // Also for what is not a number.
  return static_cast<std::int64_t>(std::min(cell, static_cast<double>(count - 1)));
}

}  // namespace

std::int64_t SphereGrid::column_of(double x) const {
  return index_of(x - low_.x(), cell_m_, columns_);
}

std::int64_t SphereGrid::row_of(double z) const {
  return index_of(z - low_.y(), cell_m_, rows_);
}

void SphereGrid::build(std::span<const Sphere> spheres) {
  entries_.clear();
  if (spheres.empty()) return;
  low_ = high_ = Eigen::Vector2d(spheres[0].centre.x(), spheres[0].centre.z());
  reach_m_ = 0;
  for (const Sphere& sphere : spheres) {
    const Eigen::Vector2d at(sphere.centre.x(), sphere.centre.z());
    low_ = low_.cwiseMin(at);
    high_ = high_.cwiseMax(at);
    reach_m_ = std::max(reach_m_, sphere.radius);
  }
  const Eigen::Vector2d size = high_ - low_;
  const auto count = static_cast<double>(spheres.size());
  // For a row of spheres the longer side alone bounds the number of cells.
  cell_m_ = std::max({cell_min_m, std::sqrt(size.x() * size.y() / (cells_per_sphere * count)),
                      size.maxCoeff() / (cells_per_sphere * count)});
  columns_ = static_cast<std::int64_t>(size.x() / cell_m_) + 1;
  rows_ = static_cast<std::int64_t>(size.y() / cell_m_) + 1;

  start_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
  const auto slot_of = [&](const Sphere& sphere) {
    return slot(column_of(sphere.centre.x()), row_of(sphere.centre.z()));
  };
  for (const Sphere& sphere : spheres) ++start_[slot_of(sphere) + 1];
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  end_.assign(start_.begin(), start_.end() - 1);
  entries_.resize(spheres.size());
  for (std::uint32_t i = 0; i < spheres.size(); ++i)
    entries_[end_[slot_of(spheres[i])]++] = {spheres[i], i};
}

SphereGrid::Cells SphereGrid::around(const Sphere& sphere) const {
  const double reach = sphere.radius + reach_m_;
  const double x = sphere.centre.x(), z = sphere.centre.z();
  const bool apart = entries_.empty() || x + reach < low_.x() || x - reach > high_.x() ||
                     z + reach < low_.y() || z - reach > high_.y();
  if (apart) return {0, -1, 0, -1};
  return {column_of(x - reach), column_of(x + reach), row_of(z - reach), row_of(z + reach)};
}

bool SphereGrid::any(const Sphere& sphere) const {
  const Cells cells = around(sphere);
  for (std::int64_t z = cells.low_z; z <= cells.high_z; ++z)
    for (std::int64_t x = cells.low_x; x <= cells.high_x; ++x)
      for (std::uint32_t k = start_[slot(x, z)]; k < end_[slot(x, z)]; ++k)
        if (entries_[k].sphere.overlaps(sphere)) return true;
  return false;
}

void SphereGrid::find(const Sphere& sphere, std::vector<std::uint32_t>& found) const {
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  const Cells cells = around(sphere);
  for (std::int64_t z = cells.low_z; z <= cells.high_z; ++z)
    for (std::int64_t x = cells.low_x; x <= cells.high_x; ++x)
      for (std::uint32_t k = start_[slot(x, z)]; k < end_[slot(x, z)]; ++k)
        if (entries_[k].sphere.overlaps(sphere)) found.push_back(entries_[k].index);
  std::sort(found.begin() + before, found.end());
}

void SphereGrid::take(const Sphere& sphere, std::vector<std::uint32_t>& found) {
  const Cells cells = around(sphere);
  for (std::int64_t z = cells.low_z; z <= cells.high_z; ++z)
    for (std::int64_t x = cells.low_x; x <= cells.high_x; ++x) {
      std::uint32_t& end = end_[slot(x, z)];
      for (std::uint32_t k = start_[slot(x, z)]; k < end;) {
        if (!entries_[k].sphere.overlaps(sphere)) {
          ++k;
          continue;
        }
        found.push_back(entries_[k].index);
        std::swap(entries_[k], entries_[--end]);
      }
    }
}

}  // namespace aureole
