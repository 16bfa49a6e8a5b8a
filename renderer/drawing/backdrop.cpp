// Geometry that every view has: ground rings, the sky's dome, boundary walls.
#include "renderer/drawing/backdrop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace aureole::render {
namespace {

constexpr int sectors = 28;
// Elevations of the dome's rows. Ground that ends 590 m away ends above -6° up to a height of 60 m.
constexpr std::array<float, 11> sky_degrees{90, 60, 42, 30, 21, 14, 9, 5, 2, -6, -90};
constexpr float wall_height_m = 3.2f;

float turn(int k) {
  return static_cast<float>(k) * 2 * std::numbers::pi_v<float> / static_cast<float>(sectors);
}

// Joins rows of `sectors` points each into quads.
void join_rows(int rows, int first, std::vector<std::uint16_t>& indices) {
  for (int row = 0; row + 1 < rows; ++row) {
    for (int k = 0; k < sectors; ++k) {
      const auto at = [&](int r, int s) {
        return static_cast<std::uint16_t>(first + r * sectors + s % sectors);
      };
      for (const auto i : {at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row, k),
                           at(row + 1, k + 1), at(row + 1, k)})
        indices.push_back(i);
    }
  }
}

struct Wall {
  Eigen::Vector2f from, to;  // Relative to the eye.
  float distance;
};

}  // namespace

TriangleList<Eigen::Vector2f> ground_rings(float reach_m) {
  constexpr std::array<float, 14> radii{1.5f, 4,  8,   14,  22,  32,  46,
                                        64,   90, 125, 170, 230, 310, 420};
  TriangleList<Eigen::Vector2f> rings;
  rings.points.emplace_back(0, 0);
  int rows = 0;
  const auto add_row = [&](float radius) {
    for (int k = 0; k < sectors; ++k)
      rings.points.emplace_back(radius * std::cos(turn(k)), radius * std::sin(turn(k)));
    ++rows;
  };
  for (const float radius : radii)
    if (radius < reach_m) add_row(radius);
  add_row(reach_m);
  for (int k = 0; k < sectors; ++k)
    for (const int i : {0, 1 + k, 1 + (k + 1) % sectors})
      rings.indices.push_back(static_cast<std::uint16_t>(i));
  join_rows(rows, 1, rings.indices);
  return rings;
}

TriangleList<Eigen::Vector3f> sky_dome() {
  TriangleList<Eigen::Vector3f> dome;
  for (const float elevation : sky_degrees) {
    const float e = elevation * std::numbers::pi_v<float> / 180;
    for (int k = 0; k < sectors; ++k) {
      dome.points.emplace_back(std::cos(e) * std::cos(turn(k)), std::sin(e),
                               std::cos(e) * std::sin(turn(k)));
    }
  }
  join_rows(static_cast<int>(sky_degrees.size()), 0, dome.indices);
  return dome;
}

std::size_t sky_above_ground_indices() {
  // All rows but the last one.
  return (sky_degrees.size() - 2) * sectors * 6;
}

void build_walls(std::span<const BoundaryLine> boundaries, const Eigen::Vector3f& eye,
                 float ground_height_m, float reach_m, std::vector<WallVertex>& out) {
  out.clear();
  std::vector<Wall> walls;
  const Eigen::Vector2f eye_xz(eye.x(), eye.z());
  for (const BoundaryLine& line : boundaries) {
    if (!line.from_xz.allFinite() || !line.to_xz.allFinite()) continue;
    const Eigen::Vector2f along = line.to_xz - line.from_xz;
    const float length = along.norm();
    if (!(length > 1e-3f)) continue;
    const Eigen::Vector2f direction = along / length;
    const float nearest = (eye_xz - line.from_xz).dot(direction);
    const float begin = std::max(0.0f, nearest - reach_m);
    const float end = std::min(length, nearest + reach_m);
    if (begin >= end) continue;
    const Eigen::Vector2f foot =
        line.from_xz + direction * std::clamp(nearest, begin, end) - eye_xz;
    if (foot.norm() > reach_m) continue;
    walls.push_back({line.from_xz + direction * begin - eye_xz,
                     line.from_xz + direction * end - eye_xz, foot.norm()});
  }
  // Blending depends on the order: the furthest first, and ties by place.
  const auto key = [](const Wall& w) {
    return std::make_tuple(-w.distance, w.from.x(), w.from.y(), w.to.x(), w.to.y());
  };
  std::sort(walls.begin(), walls.end(),
            [&](const Wall& a, const Wall& b) { return key(a) < key(b); });
  const float foot = ground_height_m - eye.y();
  for (const Wall& w : walls) {
    const WallVertex a{w.from.x(), foot, w.from.y(), 0}, b{w.to.x(), foot, w.to.y(), 0};
    const WallVertex c{b.x, foot + wall_height_m, b.z, 1}, d{a.x, foot + wall_height_m, a.z, 1};
    out.insert(out.end(), {a, b, c, a, c, d});
  }
}

}  // namespace aureole::render
