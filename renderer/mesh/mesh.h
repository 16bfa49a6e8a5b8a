// Shapes and the triangles that show them, as plain data with levels of detail.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <variant>
#include <vector>

namespace aureole::render {

/// Radius > 0 (unit: m).
struct SphereShape {
  float radius;
};
/// Half edge lengths, each > 0 (unit: m).
struct BoxShape {
  Eigen::Vector3f half_extents;
};
/// Along y. `height` is the whole height with both caps; less than 2 radius is taken as 2 radius
/// (m).
struct CapsuleShape {
  float radius;
  float height;
};
/// Along y, centred (unit: m).
struct CylinderShape {
  float radius;
  float height;
};
/// Points around the origin (unit: m). Points that span no volume are shown as the box around them.
struct HullShape {
  std::vector<Eigen::Vector3f> points;
};
using SimpleShape = std::variant<SphereShape, BoxShape, CapsuleShape, CylinderShape, HullShape>;
/// Several shapes that move as one.
struct CompoundShape {
  struct Part {
    SimpleShape shape;
    Eigen::Vector3f position{0, 0, 0};
    Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  };
  std::vector<Part> parts;
};
using MeshShape =
    std::variant<SphereShape, BoxShape, CapsuleShape, CylinderShape, HullShape, CompoundShape>;

/// What a Renderer's mesh table is made from.
struct MeshDescription {
  MeshShape shape;
  /// Marks that show how a thing turns: stripes on round shapes, edges on boxes.
  bool marked = true;
};

/// 32 bytes, as the vertex shader reads it. The fragment shader draws the mark where
/// max(|mark_u| - mark_u_limit, |mark_v| - mark_v_limit) > 0; all four in m.
struct Vertex {
  float x, y, z;
  std::int8_t normal_x, normal_y, normal_z;  ///< 127 is 1.
  std::int8_t mark_tone;  ///< 127 mixes the mark to white, -127 to black, 0 shows no mark.
  float mark_u, mark_v, mark_u_limit, mark_v_limit;
};
static_assert(sizeof(Vertex) == 32);

/// Closed triangles, counter-clockwise seen from outside.
struct MeshLevel {
  std::vector<Vertex> vertices;
  std::vector<std::uint16_t> indices;
  std::size_t triangles() const { return indices.size() / 3; }
};

/// At most this many levels: one for close-ups, then four for the distances at which most bodies
/// are.
inline constexpr int level_count_max = 5;

struct Mesh {
  std::vector<MeshLevel> levels;  ///< Most detailed first; 1 … level_count_max.
  float bounding_radius = 0;      ///< Around the origin; holds every vertex of every level (m).
  /// Half extents of the box around the origin that holds the mesh, for shadows (m).
  Eigen::Vector3f half_extents{0, 0, 0};
  float point_radius = 0;  ///< Radius of the disc that covers about as much as the mesh does (m).
  float point_lightness = 0;  ///< How far marks lighten the mesh on average, -1 … 1.
};

/// Triangles for a shape. Round shapes have smooth normals, boxes, hulls and flat ends flat ones.
/// All levels but the close-up one of a simple shape have at most 100 triangles.
Mesh make_mesh(const MeshDescription& description);

}  // namespace aureole::render
