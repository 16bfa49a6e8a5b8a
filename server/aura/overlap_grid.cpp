// The grid: one counting sort by cell, then a scan of the cells around a box.
#include "server/aura/overlap_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Worlds are wide and mostly empty: past this many cells the outer ones share the last row.
constexpr std::int64_t side_max = 1024;

}  // namespace

OverlapGrid::Cell OverlapGrid::cell_of(const Eigen::Vector3d& at) const {
  const auto index = [](double metres, std::int64_t count) {
    const double cell = std::floor(metres / cell_m);
    if (!(cell > 0)) return std::int64_t{0};  // Also for what is not a number.
    return static_cast<std::int64_t>(std::min(cell, static_cast<double>(count - 1)));
  };
  return {index(at.x() - origin_.x(), columns_), index(at.z() - origin_.y(), rows_)};
}

void OverlapGrid::build(std::span<const AuraBox> boxes) {
  boxes_ = boxes;
  reach_m_ = 0;
  order_.resize(boxes.size());
  if (boxes.empty()) return;
  Eigen::Vector2d low(boxes[0].centre.x(), boxes[0].centre.z()), high = low;
  for (const AuraBox& box : boxes) {
    const Eigen::Vector2d at(box.centre.x(), box.centre.z());
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
    reach_m_ = std::max({reach_m_, box.half.x(), box.half.z()});
  }
  origin_ = low;
  const auto cells = [](double metres) {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(metres / cell_m) + 1, 1, side_max);
  };
  columns_ = cells(high.x() - low.x());
  rows_ = cells(high.y() - low.y());

  start_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
  const auto slot = [&](const AuraBox& box) {
    const Cell cell = cell_of(box.centre);
    return static_cast<std::size_t>(cell.z * columns_ + cell.x);
  };
  for (const AuraBox& box : boxes) ++start_[slot(box) + 1];
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) order_[next[slot(boxes[i])]++] = i;
}

void OverlapGrid::find(const AuraBox& box, std::vector<std::uint32_t>& found) const {
  if (boxes_.empty()) return;
  const auto before = found.size();
  const Eigen::Vector3d reach(box.half.x() + reach_m_, 0, box.half.z() + reach_m_);
  const Cell low = cell_of(box.centre - reach), high = cell_of(box.centre + reach);
  for (std::int64_t z = low.z; z <= high.z; ++z)
    for (std::int64_t x = low.x; x <= high.x; ++x) {
      const auto cell = static_cast<std::size_t>(z * columns_ + x);
      for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k)
        if (boxes_[order_[k]].overlaps(box)) found.push_back(order_[k]);
    }
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(before), found.end());
}

}  // namespace aureole
