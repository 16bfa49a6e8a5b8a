// Finds overlapping spheres through a flat grid that is rebuilt for every step.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace aureole {

/// In world coordinates (unit: m). Radius ≥ 0.
struct Sphere {
  Eigen::Vector3d centre{0, 0, 0};
  double radius = 0;
  bool overlaps(const Sphere& other) const {
    const double reach = radius + other.radius;
    return (centre - other.centre).squaredNorm() <= reach * reach;
  }
};

/// x–z grid filled by a counting sort, with what spheres of one large radius need
/// besides: an early end ("is anything there?"), and spheres that are taken out as they are found,
/// so that a heap in which everything overlaps everything is walked through once and not squared.
class SphereGrid {
 public:
  /// Copies the spheres.
  void build(std::span<const Sphere> spheres);

  /// Whether any sphere that has not been taken overlaps `sphere`.
  bool any(const Sphere& sphere) const;
  /// Appends the indices of all that overlap `sphere` and have not been taken, ascending.
  void find(const Sphere& sphere, std::vector<std::uint32_t>& found) const;
  /// The same, and takes them: nothing finds them again until the next build(). Their order is that
  /// of the grid, the same for the same spheres.
  void take(const Sphere& sphere, std::vector<std::uint32_t>& found);

 private:
  /// Edge of a cell at least (unit: m): about the size of one aura.
  static constexpr double cell_min_m = 4.0;

  struct Cells {
    std::int64_t low_x, high_x, low_z, high_z;
  };
  Cells around(const Sphere& sphere) const;
  std::int64_t column_of(double x) const;
  std::int64_t row_of(double z) const;
  std::size_t slot(std::int64_t x, std::int64_t z) const {
    return static_cast<std::size_t>(z * columns_ + x);
  }

  struct Entry {
    Sphere sphere;
    std::uint32_t index;
  };
  std::vector<Entry> entries_;        ///< By cell.
  std::vector<std::uint32_t> start_;  ///< Of each cell in `entries_`.
  std::vector<std::uint32_t> end_;    ///< Of what has not been taken from it.
  Eigen::Vector2d low_{0, 0}, high_{0, 0};
  double cell_m_ = cell_min_m;
  double reach_m_ = 0;  ///< Largest radius.
  std::int64_t columns_ = 0, rows_ = 0;
};

}  // namespace aureole
