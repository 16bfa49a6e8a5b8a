// Geometry that every view has: ground rings, the sky's dome, boundary walls.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/scene.h"

namespace aureole::render {

/// A triangle list over points.
template <class Point>
struct TriangleList {
  std::vector<Point> points;
  std::vector<std::uint16_t> indices;
};

/// Rings around the eye in the ground's plane (x, z; m), closer where fog and light change faster.
TriangleList<Eigen::Vector2f> ground_rings(float reach_m);

/// Unit directions all around from the zenith down, rows closer together near the horizon.
TriangleList<Eigen::Vector3f> sky_dome();

/// How many of the dome's indices cover what is seen above ground that reaches far out.
std::size_t sky_above_ground_indices();

/// One corner of a boundary wall, as the vertex shader reads it: relative to the eye (m).
struct WallVertex {
  float x, y, z;
  float up;  ///< 0 at the foot, 1 at the top.
};

/// Two triangles for each wall that is near enough to be seen, the furthest first. Boundaries may
/// reach far beyond the world: each is cut to `reach_m` around the eye. Non-finite ones are left
/// out.
void build_walls(std::span<const BoundaryLine> boundaries, const Eigen::Vector3f& eye,
                 float ground_height_m, float reach_m, std::vector<WallVertex>& out);

}  // namespace aureole::render
