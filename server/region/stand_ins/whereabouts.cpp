// Squares that are near to a square.
#include "server/region/stand_ins/whereabouts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aureole {
namespace {

std::size_t squares(double extent_m, double edge_m, std::size_t most) {
  const double count = std::ceil(extent_m / edge_m);
  return count > 1 ? std::min(most, static_cast<std::size_t>(count)) : 1;
}

}  // namespace

Whereabouts::Whereabouts(const Box3& bounds, double largest_radius_m)
    : low_x_(bounds.min.x()), low_z_(bounds.min.z()) {
  constexpr double least_m = 8;
  const Eigen::Vector3d extent = bounds.max - bounds.min;
  edge_m_ = std::max({least_m, 2 * largest_radius_m, extent.x() / double{side_max},
                      extent.z() / double{side_max}});
  per_edge_ = 1 / edge_m_;
  columns_ = squares(extent.x(), edge_m_, side_max);
  rows_ = squares(extent.z(), edge_m_, side_max);
  noted_.assign(columns_ * rows_, 0);
  near_ = noted_;
}

void Whereabouts::mark(std::size_t square) {
  constexpr std::size_t around = 2;
  noted_[square] = 1;
  const std::size_t row = square / columns_, column = square % columns_;
  const std::size_t first = column - std::min(column, around);
  const std::size_t last = std::min(column + around, columns_ - 1);
  for (std::size_t r = row - std::min(row, around); r <= std::min(row + around, rows_ - 1); ++r)
    for (std::size_t c = first; c <= last; ++c) {
      std::uint8_t& near = near_[r * columns_ + c];
      if (near == 0) grown_ = true;
      near = 1;
    }
}

void Whereabouts::forget_all() {
  std::fill(noted_.begin(), noted_.end(), std::uint8_t{0});
  std::fill(near_.begin(), near_.end(), std::uint8_t{0});
}

bool Whereabouts::take_grown() {
  return std::exchange(grown_, false);
}

}  // namespace aureole
