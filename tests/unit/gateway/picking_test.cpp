// What the crosshair finds.
#include "server/gateway/players/picking.h"

#include <cmath>
#include <numbers>

#include "tests/support/catch.h"
#include "tests/unit/gateway/support/small_world.h"

using namespace aureole;
using namespace aureole::test;
using Eigen::Vector3f;

namespace {

constexpr float pi = std::numbers::pi_v<float>;

ReplicaPose pose(std::uint32_t n, PrototypeId kind, WorldPosition at) {
  ReplicaPose p;
  p.id = BodyId::world(n);
  p.prototype = kind;
  p.position = at;
  return p;
}

/// From the eye at (0, 1.6, 0), along -z unless `look` says otherwise.
std::optional<BodyId> pick(std::vector<ReplicaPose> poses, Look look = {}) {
  static const WorldDefinition world = small_world();
  return pick_body(world, poses, {{0, 1.6, 0}, look});
}

}  // namespace

TEST_CASE("Yaw 0 looks along -z and grows to the left, pitch grows upwards") {
  REQUIRE((look_direction({0, 0}) - Vector3f(0, 0, -1)).norm() < 1e-6f);
  REQUIRE((look_direction({pi / 2, 0}) - Vector3f(-1, 0, 0)).norm() < 1e-6f);
  REQUIRE((look_direction({0, pi / 2}) - Vector3f(0, 1, 0)).norm() < 1e-6f);
}

TEST_CASE("A ray meets each shape at its surface") {
  const Vector3f from(0, 0, 10), along(0, 0, -1);
  const auto hit = [&](const Shape& shape) { return ray_hits(shape, from, along); };
  REQUIRE(*hit(SphereShape{1}) == Approx(9));
  REQUIRE(*hit(BoxShape{{1, 1, 2}}) == Approx(8));
  REQUIRE(*hit(CapsuleShape{0.5f, 2}) == Approx(9.5));
  REQUIRE(*hit(CylinderShape{0.5f, 2}) == Approx(9.5));
  ConvexHullShape hull;
  for (const float x : {-1.f, 1.f})
    for (const float y : {-1.f, 1.f})
      for (const float z : {-3.f, 1.f}) hull.points.push_back({x, y, z});
  REQUIRE(*hit(hull) == Approx(9));
  CompoundShape compound;
  compound.children = {{std::make_shared<const Shape>(SphereShape{1}), {5, 0, 0}, {}},
                       {std::make_shared<const Shape>(SphereShape{1}), {0, 0, 3}, {}}};
  compound.children[0].orientation.setIdentity();
  compound.children[1].orientation.setIdentity();
  REQUIRE(*hit(compound) == Approx(6));
}

TEST_CASE("A ray passes shapes that it does not touch") {
  const Vector3f along(0, 0, -1);
  REQUIRE_FALSE(ray_hits(SphereShape{1}, {1.01f, 0, 10}, along));
  REQUIRE_FALSE(ray_hits(BoxShape{{1, 1, 1}}, {0, 1.01f, 10}, along));
  REQUIRE_FALSE(ray_hits(CapsuleShape{0.5f, 2}, {0, 1.01f, 10}, along));
  REQUIRE_FALSE(ray_hits(CylinderShape{0.5f, 2}, {0, 1.01f, 10}, along));
  REQUIRE_FALSE(ray_hits(SphereShape{1}, {0, 0, -10}, along));  // behind
  REQUIRE_FALSE(ray_hits(BoxShape{{1, 1, 1}}, {0, 0, -10}, along));
  REQUIRE_FALSE(ray_hits(CylinderShape{0.5f, 2}, {0, 0, -10}, along));
  REQUIRE_FALSE(ray_hits(PlaneShape{}, {0, 1, 0}, along));
  REQUIRE(*ray_hits(PlaneShape{}, {0, 1, 0}, {0, -1, 0}) == Approx(1));
  REQUIRE(*ray_hits(CylinderShape{0.5f, 2}, {0, 5, 0}, {0, -1, 0}) == Approx(4));  // on its end
  REQUIRE(*ray_hits(CapsuleShape{0.5f, 2}, {0, 5, 0}, {0, -1, 0}) == Approx(4));
}

TEST_CASE("The nearest body in the crosshair is picked, whatever the order of the poses") {
  const auto near = pose(1, crate_kind, {0, 1.6, -2}), far = pose(2, ball_kind, {0, 1.6, -4});
  REQUIRE(pick({near, far}) == near.id);
  REQUIRE(pick({far, near}) == near.id);
}

TEST_CASE("A body turned by 45 degrees is met at its edge") {
  auto crate = pose(1, crate_kind, {0.6, 1.6, -2});
  REQUIRE_FALSE(pick({crate}));  // half edge 0.5 m: the ray passes 0.1 m beside it
  crate.orientation = Eigen::AngleAxisf(pi / 4, Vector3f::UnitY());
  REQUIRE(pick({crate}) == crate.id);  // its corner now reaches 0.7 m
}

TEST_CASE("Nothing out of reach, too heavy, or alive is picked") {
  REQUIRE(pick({pose(1, ball_kind, {0, 1.6, -4.75})}));  // its surface is 4.45 m away
  REQUIRE_FALSE(pick({pose(1, ball_kind, {0, 1.6, -4.85})}));
  REQUIRE_FALSE(pick({pose(1, rock_kind, {0, 1.6, -2})}));
  auto someone = pose(1, avatar_kind, {0, 1.6, -2});
  someone.id = BodyId::avatar(PlayerId{5});
  REQUIRE_FALSE(pick({someone}));
}

TEST_CASE("What stands behind something heavy, a wall or the ground is not reached through it") {
  const auto ball = pose(1, ball_kind, {0, 1.6, -3});
  REQUIRE(pick({ball}) == ball.id);
  REQUIRE_FALSE(pick({ball, pose(2, rock_kind, {0, 1.6, -1.5})}));
  REQUIRE_FALSE(pick({pose(1, ball_kind, {0, -0.4, -1})}, {0, -std::atan(2.0f)}));
  static const WorldDefinition world = small_world();
  const std::vector<ReplicaPose> behind_wall = {pose(1, ball_kind, {-21, 1.6, 0})};
  REQUIRE_FALSE(pick_body(world, behind_wall, {{-18.5, 1.6, 0}, {pi / 2, 0}}));
  const std::vector<ReplicaPose> before_wall = {pose(1, ball_kind, {-19.5, 1.6, 0})};
  REQUIRE(pick_body(world, before_wall, {{-18.5, 1.6, 0}, {pi / 2, 0}}));
}
