// The lines along which regions end, and how they give way to who has less to do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/partition/partition_map.h"
#include "server/base/world_position.h"

namespace aureole {

/// A map whose lines can be moved. A line is everything that lies at one x, or at one z, and moves
/// as a whole, so that the areas tile the plane as before. It stays so near to its place that the
/// lines keep their order: who is a neighbour of whom does not change.
class PartitionLines {
 public:
  /// Lines move by no more than this (m), and by an eighth of the way to the next one.
  static constexpr double shift_max_m = 12;
  /// For one side of a line having twice the mean of both sides to do, the other one nothing (m).
  /// With more than this lines overshoot: what they give away comes only seconds later.
  static constexpr double gain_m = 400;
  /// They move in steps of this (m).
  static constexpr double grain_m = 0.25;
  /// See far_m().
  static constexpr double far_max_m = 45;

  explicit PartitionLines(const PartitionMap& map);

  std::size_t count() const { return lines_.size(); }
  /// How far each line lies from its place in the map, towards greater coordinates (m), if regions
  /// have so much to do: proportional to the difference between the means of both sides, into the
  /// side that has more. All of that only where both means are 2 or more, and nothing where one is
  /// 1: a heap that one server has by itself cannot be shared out, and would only go to and fro.
  /// `loads`: by region, finite, at least 1, which is as much as nothing.
  std::vector<double> shifts_m(std::span<const double> loads) const;
  /// The areas of the map with its lines there; `shifts_m` has one for each line.
  std::vector<Rectangle> areas(std::span<const double> shifts_m) const;
  /// shifts_m() moves no line further from its place than this (m).
  double longest_shift_m() const;

  /// How far a line may be moved to where less happens (m): 45, and 0.3 of the way to the next one.
  double far_m(std::size_t line) const { return lines_[line].far_m; }
  /// How far a point lies from the line's place in the map, towards greater coordinates (m).
  double beyond_m(std::size_t line, const WorldPosition& at) const;
  /// Whose areas end at the line, and whose begin there; ascending.
  std::span<const RegionId> below(std::size_t line) const { return lines_[line].below; }
  std::span<const RegionId> above(std::size_t line) const { return lines_[line].above; }

 private:
  struct Line {
    double Rectangle::*min;  ///< Which side of an area it may be.
    double Rectangle::*max;
    double at_m = 0;
    double shift_max_m = 0, far_m = 0;
    std::vector<RegionId> below, above;  ///< Whose areas end here, and whose begin.
  };
  void find_lines(double Rectangle::*min, double Rectangle::*max);

  std::vector<Rectangle> areas_;  ///< As the map has them.
  std::vector<Line> lines_;       ///< Those of one x first; each kind ascending.
};

}  // namespace aureole
