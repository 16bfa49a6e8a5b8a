// Triangles of one shape at one level of detail, gathered step by step.
#include "renderer/mesh/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "renderer/mesh/convex_hull.h"
#include "renderer/outcome.h"

namespace aureole::render {
namespace {

using Eigen::Vector3f;

std::int8_t to_signed_byte(float v) {
  return static_cast<std::int8_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 127.0f));
}

// Polyhedra on the unit sphere, subdivided; shared vertices stay shared.
struct UnitSphere {
  std::vector<Vector3f> points;
  std::vector<std::array<int, 3>> faces;
};

UnitSphere octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

// With a vertex at each pole, so that stripes in y look alike all around.
UnitSphere icosahedron() {
  UnitSphere s;
  const float y = 1.0f / std::sqrt(5.0f), r = 2.0f * y;
  s.points.emplace_back(0, 1, 0);
  for (int k = 0; k < 10; ++k) {
    const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 5.0f;
    s.points.emplace_back(r * std::sin(angle), k % 2 == 0 ? y : -y, r * std::cos(angle));
  }
  s.points.emplace_back(0, -1, 0);
  for (int k = 0; k < 10; k += 2) {
    const int upper = 1 + k, lower = 1 + (k + 1) % 10;
    const int next_upper = 1 + (k + 2) % 10, next_lower = 1 + (k + 3) % 10;
    s.faces.push_back({0, upper, next_upper});
    s.faces.push_back({upper, lower, next_upper});
    s.faces.push_back({lower, next_lower, next_upper});
    s.faces.push_back({11, next_lower, lower});
  }
  return s;
}

void subdivide(UnitSphere& s) {
  std::map<std::pair<int, int>, int> midpoints;
  const auto midpoint = [&](int a, int b) {
    const auto [it, is_new] =
        midpoints.try_emplace(std::minmax(a, b), static_cast<int>(s.points.size()));
    if (is_new) {
      s.points.push_back(
          (s.points[static_cast<std::size_t>(a)] + s.points[static_cast<std::size_t>(b)])
              .normalized());
    }
    return it->second;
  };
  std::vector<std::array<int, 3>> finer;
  for (const auto [a, b, c] : s.faces) {
    const int ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  s.faces = std::move(finer);
}

}  // namespace

std::uint16_t MeshBuilder::vertex(const Vector3f& position, const Surface& surface) {
  check(target_.vertices.size() < 65535, "one level of a mesh has fewer than 65535 vertices");
  const Vector3f p = pose_ * position;
  const Vector3f n = (pose_.linear() * surface.normal).normalized();
  target_.vertices.push_back({p.x(), p.y(), p.z(), to_signed_byte(n.x()), to_signed_byte(n.y()),
                              to_signed_byte(n.z()), to_signed_byte(surface.mark.tone), surface.u,
                              surface.v, surface.mark.u_limit, surface.mark.v_limit});
  return static_cast<std::uint16_t>(target_.vertices.size() - 1);
}

void MeshBuilder::triangle(std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  target_.indices.insert(target_.indices.end(), {a, b, c});
}

void MeshBuilder::box(const Vector3f& half_extents, float edge_width) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
    const float u = half_extents[u_axis], v = half_extents[v_axis];
    const Mark mark = edge_width > 0 ? Mark{-0.42f, u - edge_width, v - edge_width} : Mark{};
    for (const float side : {1.0f, -1.0f}) {
      const Vector3f normal = Vector3f::Unit(axis) * side;
      std::array<std::uint16_t, 4> corner{};
      const std::array<std::array<float, 2>, 4> around{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      for (std::size_t k = 0; k < 4; ++k) {
        Vector3f p = normal * half_extents[axis];
        // Mirrored on the negative side, so that both wind the same way seen from outside.
        p[u_axis] = around[k][0] * u * side;
        p[v_axis] = around[k][1] * v;
        corner[k] = vertex(p, {normal, p[u_axis], p[v_axis], mark});
      }
      triangle(corner[0], corner[1], corner[2]);
      triangle(corner[0], corner[2], corner[3]);
    }
  }
}

void MeshBuilder::sphere(float radius, bool use_octahedron, int subdivisions, const Mark& mark) {
  UnitSphere s = use_octahedron ? octahedron() : icosahedron();
  for (int k = 0; k < subdivisions; ++k) subdivide(s);
  const std::size_t first = target_.vertices.size();
  for (const Vector3f& n : s.points) vertex(n * radius, {n, n.y() * radius, 0, mark});
  const auto index = [&](int k) {
    return static_cast<std::uint16_t>(first + static_cast<std::size_t>(k));
  };
  for (const auto [a, b, c] : s.faces) triangle(index(a), index(b), index(c));
}

void MeshBuilder::capsule(float radius, float height, int sectors, int rings, const Mark& mark) {
  const float straight = std::max(0.0f, height / 2 - radius);
  const auto on_cap = [&](float up, float elevation, float azimuth) {
    const Vector3f n(std::cos(elevation) * std::sin(azimuth), up * std::sin(elevation),
                     std::cos(elevation) * std::cos(azimuth));
    const Vector3f p = n * radius + Vector3f(0, up * straight, 0);
    return vertex(p, {n, p.y(), 0, mark});
  };
  // Rings from the upper pole down: `rings` on each half sphere, the last of each at its rim.
  const float quarter = std::numbers::pi_v<float> / 2;
  const std::uint16_t top = on_cap(1, quarter, 0);
  std::vector<std::uint16_t> previous, current;
  for (int ring = 1; ring <= 2 * rings; ++ring) {
    const bool upper = ring <= rings;
    const int from_rim = upper ? rings - ring : ring - rings - 1;
    const float elevation = quarter * static_cast<float>(from_rim) / static_cast<float>(rings);
    current.clear();
    for (int k = 0; k < sectors; ++k) {
      const float azimuth =
          static_cast<float>(k) * 2 * std::numbers::pi_v<float> / static_cast<float>(sectors);
      current.push_back(on_cap(upper ? 1.0f : -1.0f, elevation, azimuth));
    }
    for (std::size_t k = 0; k < current.size(); ++k) {
      const std::size_t next = (k + 1) % current.size();
      if (ring == 1) {
        triangle(top, current[k], current[next]);
      } else {
        triangle(previous[k], current[k], current[next]);
        triangle(previous[k], current[next], previous[next]);
      }
    }
    previous = current;
  }
  const std::uint16_t bottom = on_cap(-1, quarter, 0);
  for (std::size_t k = 0; k < previous.size(); ++k)
    triangle(previous[k], bottom, previous[(k + 1) % previous.size()]);
}

void MeshBuilder::cylinder(float radius, float height, int sectors, const Mark& mark) {
  std::vector<Vector3f> around;
  for (int k = 0; k < sectors; ++k) {
    const float azimuth =
        static_cast<float>(k) * 2 * std::numbers::pi_v<float> / static_cast<float>(sectors);
    around.emplace_back(std::sin(azimuth), 0, std::cos(azimuth));
  }
  const Vector3f up(0, height / 2, 0);
  std::vector<std::uint16_t> wall_top, wall_bottom;
  for (const Vector3f& n : around) {
    wall_top.push_back(vertex(n * radius + up, {n, n.x() * radius, 0, mark}));
    wall_bottom.push_back(vertex(n * radius - up, {n, n.x() * radius, 0, mark}));
  }
  for (std::size_t k = 0; k < around.size(); ++k) {
    const std::size_t next = (k + 1) % around.size();
    triangle(wall_top[k], wall_bottom[k], wall_bottom[next]);
    triangle(wall_top[k], wall_bottom[next], wall_top[next]);
  }
  for (const float side : {1.0f, -1.0f}) {
    std::vector<std::uint16_t> rim;
    for (const Vector3f& n : around)
      rim.push_back(
          vertex(n * radius + up * side, {Vector3f(0, side, 0), n.x() * radius, 0, mark}));
    for (std::size_t k = 1; k + 1 < rim.size(); ++k) {
      if (side > 0)
        triangle(rim[0], rim[k], rim[k + 1]);
      else
        triangle(rim[0], rim[k + 1], rim[k]);
    }
  }
}

bool MeshBuilder::hull(std::span<const Vector3f> points) {
  const auto faces = convex_hull(points);
  for (const auto& face : faces) {
    const auto point = [&](std::size_t k) { return points[static_cast<std::size_t>(face[k])]; };
    const Vector3f normal = (point(1) - point(0)).cross(point(2) - point(0)).normalized();
    const auto a = vertex(point(0), {normal}), b = vertex(point(1), {normal}),
               c = vertex(point(2), {normal});
    triangle(a, b, c);
  }
  return !faces.empty();
}

}  // namespace aureole::render
