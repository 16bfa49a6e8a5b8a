// Places at equal distances along a polyline or a Catmull-Rom curve.
#include <algorithm>
#include <cmath>

#include "server/worlds/reading/arrangement.h"

namespace aureole {
namespace {

using Eigen::Vector3d;

/// Pieces that a curve between two points is cut into.
constexpr int pieces_per_span = 32;

/// Uniform Catmull-Rom. Source: Catmull and Rom, "A class of local interpolating splines", 1974.
Vector3d catmull_rom(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
                     double t) {
  return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t +
                (3 * b - a - 3 * c + d) * t * t * t);
}

std::vector<Vector3d> smoothed(const std::vector<Vector3d>& points, bool closed) {
  const auto n = static_cast<std::ptrdiff_t>(points.size());
  const auto point = [&](std::ptrdiff_t i) {
    return closed ? points[static_cast<std::size_t>((i + n) % n)]
                  : points[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, n - 1))];
  };
  std::vector<Vector3d> out{points.front()};
  for (std::ptrdiff_t i = 0; i < (closed ? n : n - 1); ++i) {
    for (int k = 1; k <= pieces_per_span; ++k) {
      out.push_back(catmull_rom(point(i - 1), point(i), point(i + 1), point(i + 2),
                                static_cast<double>(k) / pieces_per_span));
    }
  }
  return out;
}

}  // namespace

std::vector<Place> places_along(const std::vector<Vector3d>& points, const PathOptions& options) {
  std::vector<Vector3d> line = points;
  if (options.smooth) {
    line = smoothed(points, options.closed);
  } else if (options.closed) {
    line.push_back(points.front());
  }
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();

  double step = options.spacing_m;
  // A hair of tolerance, so that a line of exactly n steps has its last body.
  auto count = static_cast<std::size_t>(std::min(length / step + 1e-6, 1.0 * world_bodies_max)) + 1;
  if (options.closed) {
    count = static_cast<std::size_t>(
        std::clamp(std::round(length / step), 1.0, 1.0 * world_bodies_max));
    step = length / static_cast<double>(count);
  }
  std::vector<Place> out;
  std::size_t piece = 1;
  double passed = 0;  // arc length at the start of the piece
  for (std::size_t i = 0; i < count && i < world_bodies_max; ++i) {
    const double wanted = step * static_cast<double>(i);
    while (piece + 1 < line.size() &&
           passed + (line[piece] - line[piece - 1]).norm() < wanted - 1e-9) {
      passed += (line[piece] - line[piece - 1]).norm();
      ++piece;
    }
    const Vector3d along = line[piece] - line[piece - 1];
    const double share = along.norm() > 0 ? (wanted - passed) / along.norm() : 0;
    out.push_back({line[piece - 1] + share * along, std::atan2(-along.z(), along.x()), 0});
  }
  return out;
}

}  // namespace aureole
