// The grid: one counting sort by cell, then a scan of the cells under a box.
#include "server/aura/overlap_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Worlds are wide and mostly empty: past this many cells the outer ones share the last row.
constexpr std::int32_t side_max = 1024;

std::int32_t cell_index(double metres, std::int32_t count) {
  const double cell = metres * (1 / OverlapGrid::cell_m);
  if (!(cell > 0)) return 0;  // Also for what is not a number.
  return cell < count ? static_cast<std::int32_t>(cell) : count - 1;
}

}  // namespace

OverlapGrid::Cover OverlapGrid::cover_of(const AuraBox& box) const {
  return {cell_index(box.centre.x() - box.half.x() - origin_x_, columns_),
          cell_index(box.centre.z() - box.half.z() - origin_z_, rows_),
          cell_index(box.centre.x() + box.half.x() - origin_x_, columns_),
          cell_index(box.centre.z() + box.half.z() - origin_z_, rows_)};
}

OverlapGrid::Bounds OverlapGrid::bounds_of(const AuraBox& box) {
  Bounds bounds{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double low = box.centre[i] - box.half[i], high = box.centre[i] + box.half[i];
    // More than a float is rounded by.
    const double slack = 1e-6 * (1 + std::max(std::abs(low), std::abs(high)));
    bounds.low[axis] = static_cast<float>(low - slack);
    bounds.high[axis] = static_cast<float>(high + slack);
  }
  return bounds;
}

void OverlapGrid::build(std::span<const AuraBox> boxes) {
  boxes_ = boxes;
  large_.clear();
  if (boxes.empty()) return;
  double low_x = boxes[0].centre.x(), low_z = boxes[0].centre.z(), high_x = low_x, high_z = low_z;
  for (const AuraBox& box : boxes) {
    low_x = std::min(low_x, box.centre.x());
    high_x = std::max(high_x, box.centre.x());
    low_z = std::min(low_z, box.centre.z());
    high_z = std::max(high_z, box.centre.z());
  }
  const auto cells = [](double metres) {
    return static_cast<std::int32_t>(std::clamp(metres / cell_m + 1, 1.0, double{side_max}));
  };
  origin_x_ = low_x;
  origin_z_ = low_z;
  columns_ = cells(high_x - low_x);
  rows_ = cells(high_z - low_z);

  covers_.clear();
  place_of_column_.assign(static_cast<std::size_t>(columns_), no_place);
  for (const AuraBox& box : boxes) {
    const Cover& cover = covers_.emplace_back(cover_of(box));
    if (cover.cells() > cells_max)
      large_.push_back(static_cast<std::uint32_t>(covers_.size() - 1));
    else
      for (std::int32_t x = cover.low_x; x <= cover.high_x; ++x)
        place_of_column_[static_cast<std::size_t>(x)] = 0;
  }
  // Two strips along the sides of a wide region leave most columns between them empty.
  places_ = 0;
  for (std::int32_t& place : place_of_column_)
    if (place != no_place) place = places_++;

  const auto each_cell = [&](const Cover& cover, auto&& visit) {
    for (std::int32_t z = cover.low_z; z <= cover.high_z; ++z)
      for (std::int32_t x = cover.low_x; x <= cover.high_x; ++x)
        visit(cell_at(place_of_column_[static_cast<std::size_t>(x)], z));
  };
  start_.assign(static_cast<std::size_t>(places_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Cover& cover : covers_)
    if (cover.cells() <= cells_max) each_cell(cover, [&](std::size_t cell) { ++start_[cell]; });
  // First where each cell ends; filled from behind, where it begins.
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  entries_.resize(start_.back());
  for (std::size_t i = covers_.size(); i-- > 0;) {
    const Cover& cover = covers_[i];
    if (cover.cells() > cells_max) continue;
    const Entry entry{bounds_of(boxes[i]), static_cast<std::uint32_t>(i),
                      static_cast<std::uint16_t>(cover.low_x),
                      static_cast<std::uint16_t>(cover.low_z)};
    each_cell(cover, [&](std::size_t cell) { entries_[--start_[cell]] = entry; });
  }
}

void OverlapGrid::find(const AuraBox& box, std::vector<std::uint32_t>& found) const {
  if (boxes_.empty()) return;
  const Cover cover = cover_of(box);
  if (cover.cells() > static_cast<std::int64_t>(boxes_.size() + 4)) {
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
      if (boxes_[i].overlaps(box)) found.push_back(i);
    return;
  }
  const Bounds bounds = bounds_of(box);
  for (std::int32_t z = cover.low_z; z <= cover.high_z; ++z)
    for (std::int32_t x = cover.low_x; x <= cover.high_x; ++x) {
      const std::int32_t place = place_of_column_[static_cast<std::size_t>(x)];
      if (place == no_place) continue;
      const std::size_t cell = cell_at(place, z);
      for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
        const Entry& entry = entries_[k];
        if (!entry.bounds.meets(bounds)) continue;
        if (std::max<std::int32_t>(entry.low_x, cover.low_x) != x ||
            std::max<std::int32_t>(entry.low_z, cover.low_z) != z)
          continue;
        if (boxes_[entry.box].overlaps(box)) found.push_back(entry.box);
      }
    }
  for (std::uint32_t i : large_)
    if (boxes_[i].overlaps(box)) found.push_back(i);
}

}  // namespace aureole
