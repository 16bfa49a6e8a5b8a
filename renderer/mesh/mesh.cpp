// Which levels of detail a shape has, and how large it is.
#include "renderer/mesh/mesh.h"

#include <algorithm>
#include <cmath>

#include "renderer/mesh/mesh_builder.h"

namespace aureole::render {
namespace {

using Eigen::Vector3f;

// Fewer triangles cut corners inside the true surface; a slightly larger radius keeps the seen
// area.
struct SphereLevel {
  bool octahedron;
  int subdivisions;
  float growth;
};
constexpr SphereLevel sphere_levels[level_count_max] = {
    {false, 2, 1.0f}, {false, 1, 1.015f}, {false, 1, 1.015f}, {true, 1, 1.04f}, {false, 0, 1.06f}};
struct RoundLevel {
  int sectors, rings;
};
constexpr RoundLevel capsule_levels[level_count_max] = {{18, 5}, {10, 2}, {8, 2}, {6, 1}, {5, 1}};
constexpr int cylinder_sectors[level_count_max] = {28, 16, 12, 8, 6};

constexpr float white_tone = 0.72f;

void append(const SphereShape& s, bool marked, int level, MeshBuilder& out) {
  const SphereLevel& l = sphere_levels[level];
  const Mark mark = marked ? Mark{white_tone, s.radius * 0.5f} : Mark{};
  out.sphere(s.radius * l.growth, l.octahedron, l.subdivisions, mark);
}

void append(const BoxShape& s, bool marked, int, MeshBuilder& out) {
  const float smallest = s.half_extents.minCoeff();
  out.box(s.half_extents, marked ? std::min(0.05f, smallest * 0.22f) : 0.0f);
}

void append(const CapsuleShape& s, bool marked, int level, MeshBuilder& out) {
  const RoundLevel& l = capsule_levels[level];
  // Without a straight part between them, two half spheres would share a wall without area.
  if (s.height <= 2.0001f * s.radius) return append(SphereShape{s.radius}, marked, level, out);
  const float height = s.height;
  const Mark mark = marked ? Mark{white_tone, height / 2 - 0.8f * s.radius} : Mark{};
  out.capsule(s.radius, height, l.sectors, l.rings, mark);
}

void append(const CylinderShape& s, bool marked, int level, MeshBuilder& out) {
  const Mark mark = marked ? Mark{white_tone * 0.7f, s.radius * 0.45f} : Mark{};
  out.cylinder(s.radius, s.height, cylinder_sectors[level], mark);
}

void append(const HullShape& s, bool marked, int level, MeshBuilder& out) {
  if (out.hull(s.points)) return;
  Vector3f half = Vector3f::Constant(0.01f);
  for (const Vector3f& p : s.points) {
    if (p.allFinite()) half = half.cwiseMax(p.cwiseAbs());
  }
  append(BoxShape{half}, marked, level, out);
}

// Flat shapes look the same at every level.
int levels_of(const SimpleShape& shape) {
  return std::holds_alternative<BoxShape>(shape) || std::holds_alternative<HullShape>(shape)
             ? 1
             : level_count_max;
}

void append_simple(const SimpleShape& shape, bool marked, int level, MeshBuilder& out) {
  std::visit([&](const auto& s) { append(s, marked, level, out); }, shape);
}

// What covers a body as a point: the disc of the area of an average silhouette, which for a convex
// body is a quarter of its surface (Cauchy). A compound's parts hide each other, so it counts as
// less.
float point_radius(const MeshLevel& level) {
  float area = 0;
  for (std::size_t k = 0; k + 2 < level.indices.size(); k += 3) {
    const auto corner = [&](std::size_t i) {
      const Vertex& v = level.vertices[level.indices[k + i]];
      return Vector3f(v.x, v.y, v.z);
    };
    area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
  }
  return std::sqrt(area / 4 / 3.14159265f);
}

void measure(Mesh& mesh, bool compound) {
  for (const MeshLevel& level : mesh.levels) {
    for (const Vertex& v : level.vertices) {
      const Vector3f p(v.x, v.y, v.z);
      // Rounded up, so that no vertex lies outside by a float's last bit.
      mesh.bounding_radius = std::max(mesh.bounding_radius, p.norm() * 1.000001f);
      mesh.half_extents = mesh.half_extents.cwiseMax(p.cwiseAbs());
    }
  }
  if (mesh.levels.back().vertices.empty()) return;
  mesh.point_radius = point_radius(mesh.levels.back()) * (compound ? 0.8f : 1.0f);
  float tone = 0;
  for (const Vertex& v : mesh.levels.back().vertices) {
    const bool in_mark =
        std::max(std::abs(v.mark_u) - v.mark_u_limit, std::abs(v.mark_v) - v.mark_v_limit) > 0;
    // Vertices lie on the rims, where the marks are: a box's darkened edges are a small part of it.
    if (in_mark) tone += static_cast<float>(v.mark_tone) / 127.0f;
  }
  mesh.point_lightness = 0.3f * tone / static_cast<float>(mesh.levels.back().vertices.size());
}

}  // namespace

Mesh make_mesh(const MeshDescription& description) {
  Mesh mesh;
  const auto* compound = std::get_if<CompoundShape>(&description.shape);
  if (compound == nullptr) {
    const SimpleShape simple = std::visit(
        [](const auto& s) -> SimpleShape {
          if constexpr (std::is_same_v<std::decay_t<decltype(s)>, CompoundShape>)
            return SphereShape{1};
          else
            return s;
        },
        description.shape);
    mesh.levels.resize(static_cast<std::size_t>(levels_of(simple)));
    for (std::size_t k = 0; k < mesh.levels.size(); ++k) {
      MeshBuilder builder(mesh.levels[k]);
      append_simple(simple, description.marked, static_cast<int>(k), builder);
    }
  } else {
    int levels = 1;
    for (const auto& part : compound->parts) levels = std::max(levels, levels_of(part.shape));
    mesh.levels.resize(static_cast<std::size_t>(levels));
    for (std::size_t k = 0; k < mesh.levels.size(); ++k) {
      MeshBuilder builder(mesh.levels[k]);
      for (const auto& part : compound->parts) {
        Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
        pose.linear() = part.orientation.normalized().toRotationMatrix();
        pose.translation() = part.position;
        builder.set_pose(pose);
        append_simple(part.shape, description.marked, static_cast<int>(k), builder);
      }
    }
  }
  measure(mesh, compound != nullptr);
  return mesh;
}

}  // namespace aureole::render
