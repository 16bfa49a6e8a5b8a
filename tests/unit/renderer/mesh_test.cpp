// Meshes are closed, face outwards, and lie inside their bounding radius.
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "renderer/mesh/convex_hull.h"
#include "renderer/mesh/mesh.h"
#include "tests/support/catch.h"

namespace aureole::render {
namespace {

using Eigen::Vector3f;

Vector3f position(const MeshLevel& level, std::size_t index) {
  const Vertex& v = level.vertices[level.indices[index]];
  return {v.x, v.y, v.z};
}

// Vertices are doubled where normals differ: for closedness, equal places are one corner.
std::tuple<int, int, int> place(const Vector3f& p) {
  const auto rounded = [](float v) { return static_cast<int>(std::lround(v * 1e4f)); };
  return {rounded(p.x()), rounded(p.y()), rounded(p.z())};
}

// Closed and oriented alike: each edge is used once in each direction.
bool is_closed(const MeshLevel& level) {
  std::map<std::pair<std::tuple<int, int, int>, std::tuple<int, int, int>>, int> edges;
  for (std::size_t k = 0; k < level.indices.size(); k += 3) {
    for (std::size_t e = 0; e < 3; ++e) {
      const auto from = place(position(level, k + e)), to = place(position(level, k + (e + 1) % 3));
      ++edges[{from, to}];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto reverse = edges.find({edge.second, edge.first});
    if (count != 1 || reverse == edges.end() || reverse->second != 1) return false;
  }
  return !edges.empty();
}

float volume(const MeshLevel& level) {
  float sum = 0;
  for (std::size_t k = 0; k < level.indices.size(); k += 3)
    sum += position(level, k).dot(position(level, k + 1).cross(position(level, k + 2))) / 6;
  return sum;
}

// Winding and stored normals agree: the flat normal of each triangle and its corners' normals point
// to the same side.
bool normals_agree(const MeshLevel& level) {
  for (std::size_t k = 0; k < level.indices.size(); k += 3) {
    const Vector3f flat = (position(level, k + 1) - position(level, k))
                              .cross(position(level, k + 2) - position(level, k));
    for (std::size_t c = 0; c < 3; ++c) {
      const Vertex& v = level.vertices[level.indices[k + c]];
      const Vector3f normal(v.normal_x, v.normal_y, v.normal_z);
      if (std::abs(normal.norm() - 127.0f) > 1.5f || normal.dot(flat) <= 0) return false;
    }
  }
  return true;
}

HullShape unit_cube_points() {
  HullShape hull;
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f})
      for (const float z : {-1.0f, 1.0f}) hull.points.emplace_back(x, y, z);
  return hull;
}

struct Case {
  const char* name;
  MeshShape shape;
  float true_volume;  // Of the shape itself, m³.
  float true_radius;  // Of the sphere around it, m.
};

std::vector<Case> cases() {
  constexpr float pi = 3.14159265f;
  HullShape octahedron{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  // Points inside and on faces change nothing.
  octahedron.points.emplace_back(0.1f, 0.2f, 0.1f);
  octahedron.points.emplace_back(0.5f, 0.5f, 0.0f);
  return {{"sphere", SphereShape{0.5f}, pi / 6, 0.5f},
          {"box", BoxShape{{0.5f, 1, 2}}, 8, std::sqrt(0.25f + 1 + 4)},
          {"capsule", CapsuleShape{0.3f, 1.8f}, pi * 0.09f * (1.2f + 0.4f), 0.9f},
          {"capsule that is a ball", CapsuleShape{0.5f, 0.2f}, pi / 6, 0.5f},
          {"cylinder", CylinderShape{0.5f, 2}, pi / 2, std::sqrt(1.25f)},
          {"cube hull", unit_cube_points(), 8, std::sqrt(3.0f)},
          {"octahedron hull", octahedron, 4.0f / 3, 1}};
}

}  // namespace

TEST_CASE("Every level of every shape is closed and faces outwards") {
  for (const Case& c : cases()) {
    INFO(c.name);
    const Mesh mesh = make_mesh({c.shape});
    REQUIRE(!mesh.levels.empty());
    REQUIRE(mesh.levels.size() <= std::size_t{level_count_max});
    for (const MeshLevel& level : mesh.levels) {
      CHECK(is_closed(level));
      CHECK(normals_agree(level));
      // Facets lie inside a round shape: the coarsest levels lose up to half of its volume.
      CHECK(volume(level) > 0.5f * c.true_volume);
      CHECK(volume(level) < 1.06f * c.true_volume);
    }
    CHECK(volume(mesh.levels.front()) == Approx(c.true_volume).epsilon(0.09));
  }
}

TEST_CASE("A mesh lies inside its bounding radius, and the radius is no wider than it must be") {
  for (const Case& c : cases()) {
    INFO(c.name);
    const Mesh mesh = make_mesh({c.shape});
    for (const MeshLevel& level : mesh.levels) {
      for (const Vertex& v : level.vertices) {
        const Vector3f p(v.x, v.y, v.z);
        REQUIRE(p.norm() <= mesh.bounding_radius);
        REQUIRE((p.cwiseAbs().array() <= mesh.half_extents.array()).all());
      }
    }
    CHECK(mesh.bounding_radius >= c.true_radius * 0.999f);
    // Coarse levels are a little larger, to cover the same area.
    CHECK(mesh.bounding_radius <= c.true_radius * 1.07f);
    CHECK(mesh.point_radius > 0);
    CHECK(mesh.point_radius <= mesh.bounding_radius);
  }
}

TEST_CASE("Levels get coarser, and all but the close-up one have at most 100 triangles") {
  for (const Case& c : cases()) {
    INFO(c.name);
    const Mesh mesh = make_mesh({c.shape});
    for (std::size_t k = 1; k < mesh.levels.size(); ++k) {
      CHECK(mesh.levels[k].triangles() <= mesh.levels[k - 1].triangles());
      CHECK(mesh.levels[k].triangles() <= 100);
    }
  }
  CHECK(make_mesh({BoxShape{{1, 1, 1}}}).levels.size() == 1);
  CHECK(make_mesh({SphereShape{1}}).levels.size() == 5);
}

TEST_CASE("A compound holds its parts where they are") {
  CompoundShape bell;
  bell.parts.push_back({BoxShape{{0.1f, 0.2f, 0.3f}}, {2, 0, 0}});
  // A quarter turn about z lays the y extent along x.
  const Eigen::Quaternionf quarter(Eigen::AngleAxisf(1.5707963f, Vector3f::UnitZ()));
  bell.parts.push_back({BoxShape{{0.1f, 0.2f, 0.3f}}, {0, 3, 0}, quarter});
  const Mesh mesh = make_mesh({bell});
  REQUIRE(mesh.levels.size() == 1);
  CHECK(is_closed(mesh.levels[0]));
  CHECK(volume(mesh.levels[0]) == Approx(2 * 0.048f));
  CHECK(mesh.half_extents.x() == Approx(2.1f));
  CHECK(mesh.half_extents.y() == Approx(3.1f));
  CHECK(mesh.bounding_radius == Approx(std::sqrt(3.1f * 3.1f + 0.04f + 0.09f)));
}

TEST_CASE("A compound takes as many levels as its finest part needs") {
  CompoundShape mixed;
  mixed.parts.push_back({SphereShape{0.5f}, {0, 0, 0}});
  mixed.parts.push_back({BoxShape{{0.1f, 0.1f, 0.1f}}, {1, 0, 0}});
  CHECK(make_mesh({mixed}).levels.size() == 5);
  CHECK(make_mesh({CompoundShape{}}).bounding_radius == 0);
}

TEST_CASE("Points that span no volume are shown as the box around them") {
  const HullShape flat{{{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}}};
  CHECK(convex_hull(flat.points).empty());
  const Mesh mesh = make_mesh({flat});
  CHECK(is_closed(mesh.levels[0]));
  CHECK(mesh.half_extents.x() == Approx(1));
  CHECK(mesh.half_extents.y() == Approx(0.01f));
  CHECK(convex_hull(std::vector<Vector3f>(5, Vector3f(1, 1, 1))).empty());
  CHECK(convex_hull(std::vector<Vector3f>{}).empty());
  CHECK(convex_hull(std::vector<Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, std::nanf(""), 0}, {0, 0, 1}})
            .empty());
}

TEST_CASE("No point lies outside the hull of many points") {
  std::vector<Vector3f> points;
  std::uint32_t state = 7;
  const auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) * 0x1p-23f - 1;
  };
  for (int k = 0; k < 64; ++k) {
    const float x = next(), y = next();
    points.emplace_back(x, y, next());
  }
  const auto faces = convex_hull(points);
  REQUIRE(faces.size() >= 4);
  for (const auto& [a, b, c] : faces) {
    const auto at = [&](int k) { return points[static_cast<std::size_t>(k)]; };
    const Vector3f normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    for (const Vector3f& p : points) REQUIRE((p - at(a)).dot(normal) < 1e-5f);
  }
  CHECK(is_closed(make_mesh({HullShape{points}}).levels[0]));
}

TEST_CASE("Unmarked meshes carry no marks") {
  for (const Case& c : cases()) {
    for (const MeshLevel& level : make_mesh({c.shape, false}).levels)
      for (const Vertex& v : level.vertices) REQUIRE(v.mark_tone == 0);
  }
}

}  // namespace aureole::render
