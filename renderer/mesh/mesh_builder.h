// Triangles of one shape at one level of detail, gathered step by step.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "renderer/mesh/mesh.h"

namespace aureole::render {

/// Where the mark of a surface lies, see Vertex; all lengths in m, tone -1 … 1.
struct Mark {
  float tone = 0;
  float u_limit = 1e6f, v_limit = 1e6f;
};

/// Appends closed pieces to one MeshLevel, each placed by `pose`.
class MeshBuilder {
 public:
  explicit MeshBuilder(MeshLevel& target) : target_(target) {}

  void set_pose(const Eigen::Isometry3f& pose) { pose_ = pose; }

  /// Flat faces; the mark follows the faces' rims, `edge_width` wide (0: none).
  void box(const Eigen::Vector3f& half_extents, float edge_width);
  /// A subdivided icosahedron (20 · 4^n triangles) or, for `octahedron`, octahedron (8 · 4^n).
  void sphere(float radius, bool octahedron, int subdivisions, const Mark& mark);
  /// Two half spheres of `rings` rings each around a straight wall, `sectors` around y.
  void capsule(float radius, float height, int sectors, int rings, const Mark& mark);
  /// A wall and two flat ends; the mark is a stripe in x that runs over wall and ends alike.
  void cylinder(float radius, float height, int sectors, const Mark& mark);
  /// Flat triangles of the convex hull; false if the points span no volume.
  bool hull(std::span<const Eigen::Vector3f> points);

 private:
  struct Surface {
    Eigen::Vector3f normal;
    float u = 0, v = 0;
    Mark mark{};
  };
  std::uint16_t vertex(const Eigen::Vector3f& position, const Surface& surface);
  void triangle(std::uint16_t a, std::uint16_t b, std::uint16_t c);

  MeshLevel& target_;
  Eigen::Isometry3f pose_ = Eigen::Isometry3f::Identity();
};

}  // namespace aureole::render
