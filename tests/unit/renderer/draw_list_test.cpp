// What a frame draws: hidden bodies never, visible ones always, and always in the same order.
#include "renderer/drawing/draw_list.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "renderer/drawing/backdrop.h"
#include "tests/support/catch.h"

namespace aureole::render {
namespace {

using Eigen::Vector3f;

std::vector<Mesh> meshes() {
  return {make_mesh({SphereShape{0.5f}}), make_mesh({BoxShape{{0.5f, 0.5f, 0.5f}}})};
}

Instance at(std::uint64_t key, const Vector3f& position, MeshIndex mesh = 0) {
  return {key, mesh, {10, 20, 30}, position, {0, 0, 0, 1}};
}

struct Drawing {
  std::vector<Mesh> table = meshes();
  std::vector<Instance> fixed;
  std::vector<ShadowReceiver> receivers;
  ShadowGround ground;
  View view;
  DrawList list;

  Drawing() { view.camera.eye = {0, 2, 0}; }
  void build(const std::vector<Instance>& moving) {
    list.build(table, fixed, moving, receivers, ground, view);
  }
};

bool same_bytes(std::span<const DrawnInstance> a, std::span<const DrawnInstance> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

TEST_CASE("A body behind the camera is never drawn, one in front always") {
  Drawing d;
  d.build({at(1, {0, 2, 10}), at(2, {0, 2, -10})});
  REQUIRE(d.list.instances().size() == 1);
  CHECK(d.list.instances()[0].position[2] == -10);
  CHECK(d.list.hidden() == 1);
  REQUIRE(d.list.shadows().size() == 1);
}

TEST_CASE("Positions are relative to the eye, however far from the origin") {
  Drawing d;
  d.view.camera.eye = {4096, 2, 8192};
  d.build({at(1, {4096.5f, 1, 8187})});
  REQUIRE(d.list.instances().size() == 1);
  CHECK(d.list.instances()[0].position[0] == 0.5f);
  CHECK(d.list.instances()[0].position[1] == -1);
  CHECK(d.list.instances()[0].position[2] == -5);
}

TEST_CASE("Near bodies are grouped by mesh and level, far ones become points") {
  Drawing d;
  d.build({at(4, {0, 2, -5}, 1), at(1, {0, 2, -5}), at(2, {0, 2, -200}), at(3, {1, 2, -5})});
  REQUIRE(d.list.buckets().size() == 3);
  CHECK(d.list.buckets()[0].mesh == 0);
  CHECK(d.list.buckets()[0].level >= 0);
  CHECK(d.list.buckets()[0].count == 2);
  CHECK(d.list.buckets()[1].mesh == 0);
  CHECK(d.list.buckets()[1].level == -1);
  CHECK(d.list.buckets()[1].first == 2);
  CHECK(d.list.buckets()[2].mesh == 1);
  CHECK(d.list.buckets()[2].first == 3);
}

TEST_CASE("The order in which instances come changes nothing, even among equal keys") {
  std::vector<Instance> instances;
  for (int k = 0; k < 40; ++k) {
    instances.push_back(at(static_cast<std::uint64_t>(k / 3),
                           {static_cast<float>(k % 7) - 3, 1, -6 - static_cast<float>(k)},
                           static_cast<MeshIndex>(k % 2)));
  }
  Drawing a, b;
  a.build(instances);
  std::reverse(instances.begin(), instances.end());
  std::swap(instances[3], instances[17]);
  b.build(instances);
  REQUIRE(a.list.instances().size() == 40);
  CHECK(same_bytes(a.list.instances(), b.list.instances()));
  REQUIRE(a.list.shadows().size() == b.list.shadows().size());
  CHECK(std::memcmp(a.list.shadows().data(), b.list.shadows().data(),
                    a.list.shadows().size_bytes()) == 0);
}

TEST_CASE("One's own avatar, unknown meshes and broken numbers are left out") {
  Drawing d;
  d.view.hidden_key = 7;
  Instance broken = at(3, {std::nanf(""), 2, -5});
  Instance no_turn = at(4, {0, 2, -5});
  no_turn.orientation = {0, 0, 0, 0};
  Instance infinite = at(5, {0, 2, -5});
  infinite.orientation[1] = INFINITY;
  d.build({at(7, {0, 2, -5}), at(2, {0, 2, -5}, 99), broken, no_turn, infinite, at(6, {0, 2, -5})});
  CHECK(d.list.instances().size() == 1);
  CHECK(d.list.hidden() == 5);
}

TEST_CASE("A shadow lies on the ground below its body and fades as the body rises") {
  Drawing d;
  d.build({at(1, {0, 0.5f, -6})});
  REQUIRE(d.list.shadows().size() == 1);
  const ShadowQuad low = d.list.shadows()[0];
  // The eye is 2 m above the ground; the quad hovers by millimetres to win against it.
  CHECK(low.centre[1] == Approx(-2).margin(0.02));
  CHECK(low.centre[2] == Approx(-6).margin(0.3));
  CHECK(low.strength > 0.4f);
  d.build({at(1, {0, 3.5f, -6})});
  REQUIRE(d.list.shadows().size() == 1);
  CHECK(d.list.shadows()[0].strength < 0.5f * low.strength);
  d.build({at(1, {0, 40, -60})});
  CHECK(d.list.shadows().empty());
}

TEST_CASE("A shadow falls on the platform below a body and is cut at its edge") {
  Drawing d;
  const Instance platform = at(9, {0, 0.5f, -6}, 1);
  d.receivers = {upper_face(BoxShape{{0.6f, 0.5f, 0.6f}}, platform)};
  d.build({at(1, {0.3f, 1.5f, -6})});
  REQUIRE(d.list.shadows().size() == 1);
  const ShadowQuad& quad = d.list.shadows()[0];
  CHECK(quad.centre[1] == Approx(-1).margin(0.02));
  for (int corner = 0; corner < 4; ++corner) {
    const float u = quad.bounds[corner & 1], v = quad.bounds[2 + (corner >> 1)];
    const float x = quad.centre[0] + u * quad.axis_u[0] + v * quad.axis_v[0];
    const float z = quad.centre[2] + u * quad.axis_u[2] + v * quad.axis_v[2] + 6;
    CHECK(std::abs(x) <= 0.6001f);
    CHECK(std::abs(z) <= 0.6001f);
  }
  // Beside the platform it falls on the ground again.
  d.build({at(1, {1.2f, 1.5f, -6})});
  REQUIRE(d.list.shadows().size() == 1);
  CHECK(d.list.shadows()[0].centre[1] == Approx(-2).margin(0.02));
}

TEST_CASE("Boundary walls are cut to what is near, and the furthest comes first") {
  std::vector<WallVertex> walls;
  const std::vector<BoundaryLine> lines{{{-1e6f, -5}, {1e6f, -5}},
                                        {{3, -1e6f}, {3, 1e6f}},
                                        {{5000, 0}, {5001, 0}},
                                        {{1, 1}, {1, 1}},
                                        {{0, std::nanf("")}, {1, 0}}};
  build_walls(lines, {0, 2, 0}, 0, 600, walls);
  REQUIRE(walls.size() == 12);
  CHECK(walls[0].z == -5);
  CHECK(walls[6].x == 3);
  for (const WallVertex& v : walls) {
    CHECK(std::abs(v.x) <= 600);
    CHECK(std::abs(v.z) <= 600);
    CHECK(v.y == (v.up > 0 ? walls[2].y : -2.0f));
  }
}

}  // namespace aureole::render
