// Array constructs: a few lines of JSON that place many equal bodies (grid, line, ring, wall,
// pyramid).
#pragma once

#include <optional>
#include <vector>

#include "server/worlds/reading/json_reader.h"
#include "server/worlds/reading/shape_measure.h"

namespace aureole {

/// Bodies of one world file, all constructs together.
inline constexpr std::size_t world_bodies_max = 100'000;

/// Where one body of a construct stands in the construct's own frame.
struct Place {
  Eigen::Vector3d position{0, 0, 0};
  double yaw_rad = 0;
  std::size_t layer = 0;  ///< Counted upwards; colours may go by it.
};

/// The places that the entry's one construct makes ("grid", "line", "ring", "wall" or "pyramid"),
/// or the one place of an entry that has none. `size` is the body's own extent along the
/// construct's axes (unit: m), which steps default to. Empty after a mistake; never more than
/// world_bodies_max.
std::vector<Place> read_arrangement(const JsonNode& entry, const Eigen::Vector3d& size);

/// Points at equal steps of arc length along a polyline, from its first point on; a closed one is
/// fitted so that the last step equals the others. With `smooth` the line is a Catmull-Rom curve
/// through the points. Each place's x axis points along the path.
struct PathOptions {
  double spacing_m = 1;
  bool smooth = false;
  bool closed = false;
};
std::vector<Place> places_along(const std::vector<Eigen::Vector3d>& points,
                                const PathOptions& options);

}  // namespace aureole
