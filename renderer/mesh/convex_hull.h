// The convex hull of a handful of points.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

namespace aureole::render {

using HullTriangle = std::array<int, 3>;

/// Triangles over the given points, counter-clockwise seen from outside, closed; empty if the
/// points span no volume. Incremental: each point removes the faces that see it and closes the hole
/// by a fan. Meant for up to a few hundred points; O(points × faces).
std::vector<HullTriangle> convex_hull(std::span<const Eigen::Vector3f> points);

}  // namespace aureole::render
