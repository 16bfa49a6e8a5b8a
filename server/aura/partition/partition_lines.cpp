// Sides of rectangles that lie at one coordinate, and hang together, move together.
#include "server/aura/partition/partition_lines.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "server/base/check.h"

namespace aureole {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double mean_load(const std::vector<RegionId>& regions, std::span<const double> loads) {
  double sum = 0;
  for (const RegionId region : regions) sum += loads[region.value];
  return sum / static_cast<double>(regions.size());
}

void sort_out(std::vector<double>& places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

}  // namespace

PartitionLines::PartitionLines(const PartitionMap& map) {
  for (std::uint16_t k = 0; k < map.size(); ++k) areas_.push_back(map.area(RegionId{k}));
  find_lines(&Rectangle::min_x, &Rectangle::max_x);
  find_lines(&Rectangle::min_z, &Rectangle::max_z);
}

void PartitionLines::find_lines(double Rectangle::*min, double Rectangle::*max) {
  std::vector<double> places;
  for (const Rectangle& area : areas_)
    if (std::isfinite(area.*max)) places.push_back(area.*max);
  sort_out(places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    double gap_m = infinity;
    if (i > 0) gap_m = places[i] - places[i - 1];
    if (i + 1 < places.size()) gap_m = std::min(gap_m, places[i + 1] - places[i]);
    const Line line{
        min, max, places[i], std::min(shift_max_m, gap_m / 8), std::min(far_max_m, 0.3 * gap_m),
        {},  {}};
    if (min == &Rectangle::min_z) {
      add_line(line, {-infinity, infinity});
      continue;
    }
    const std::vector<double> ends = crossings(places[i]);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) add_line(line, {ends[k], ends[k + 1]});
  }
}

/// Where areas on both sides of an x end: where it meets a z that goes on behind it, and where it
/// ends itself.
std::vector<double> PartitionLines::crossings(double at_x) const {
  std::vector<double> below, above, both;
  for (const Rectangle& area : areas_)
    for (const double end : {area.min_z, area.max_z}) {
      if (area.max_x == at_x) below.push_back(end);
      if (area.min_x == at_x) above.push_back(end);
    }
  sort_out(below);
  sort_out(above);
  std::set_intersection(below.begin(), below.end(), above.begin(), above.end(),
                        std::back_inserter(both));
  return both;
}

/// Of what lies at the line's place all between two z; nothing, where that place has a gap.
void PartitionLines::add_line(Line line, Range z) {
  for (std::uint16_t k = 0; k < areas_.size(); ++k) {
    if (areas_[k].min_z < z.from || areas_[k].max_z > z.to) continue;
    if (areas_[k].*line.max == line.at_m) line.below.push_back(RegionId{k});
    if (areas_[k].*line.min == line.at_m) line.above.push_back(RegionId{k});
  }
  AUREOLE_CHECK(line.below.empty() == line.above.empty(), "where an area ends another one begins");
  if (!line.below.empty()) lines_.push_back(std::move(line));
}

std::vector<double> PartitionLines::shifts_m(std::span<const double> loads) const {
  AUREOLE_CHECK(loads.size() == areas_.size(), "every region has a load");
  std::vector<double> shifts;
  for (const Line& line : lines_) {
    const double below = mean_load(line.below, loads), above = mean_load(line.above, loads);
    const double share = std::clamp(std::min(above, below) - 1, 0.0, 1.0);
    const double wanted_m = share * gain_m * (above - below) / (above + below);
    const double steps = std::round(wanted_m / grain_m);
    shifts.push_back(std::clamp(steps * grain_m, -line.shift_max_m, line.shift_max_m));
  }
  return shifts;
}

std::vector<Rectangle> PartitionLines::areas(std::span<const double> shifts_m) const {
  AUREOLE_CHECK(shifts_m.size() == lines_.size(), "every line has a shift");
  std::vector<Rectangle> moved = areas_;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    for (const RegionId region : line.below) moved[region.value].*line.max += shifts_m[i];
    for (const RegionId region : line.above) moved[region.value].*line.min += shifts_m[i];
  }
  return moved;
}

double PartitionLines::beyond_m(std::size_t line, const WorldPosition& at) const {
  const Line& l = lines_[line];
  return (l.min == &Rectangle::min_x ? at.x : at.z) - l.at_m;
}

double PartitionLines::longest_shift_m() const {
  double longest_m = 0;
  for (const Line& line : lines_) longest_m = std::max(longest_m, line.shift_max_m);
  return longest_m;
}

}  // namespace aureole
