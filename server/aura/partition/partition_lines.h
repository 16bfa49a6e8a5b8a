// The lines along which regions end, and how they give way to who has less to do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/partition/partition_map.h"
#include "server/base/world_position.h"

namespace aureole {

/// A map whose lines can be moved, so that the areas tile the plane as before. All that lies at one
/// z is one line and moves as a whole. What lies at one x is one line from where it meets a line of
/// one z on both sides to where it does so again: in each row of a grid the lines between its
/// regions move by themselves, so that they can make up for any difference between its regions.
/// Lines stay so near to their places that they keep their order.
class PartitionLines {
 public:
  /// Lines move by no more than this (m), and by an eighth of the way to the next one.
  static constexpr double shift_max_m = 12;
  /// For one side of a line having twice the mean of both sides to do, the other one nothing (m).
  /// With twice as much lines overshot: what they give away comes only seconds later.
  static constexpr double gain_m = 200;
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
  struct Range {
    double from = 0, to = 0;
  };
  void add_line(Line line, Range z);
  std::vector<double> crossings(double at_x) const;

  std::vector<Rectangle> areas_;  ///< As the map has them.
  std::vector<Line> lines_;       ///< Those of one x first, each from its lowest z on; ascending.
};

}  // namespace aureole
