// From replicas to scenes.
#include "server/gateway/pictures/scene_builder.h"

#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"
#include "tests/unit/gateway/support/small_world.h"

using namespace aureole;
using namespace aureole::test;

namespace {

bool same(render::Rgb a, Colour b) {
  return a.r == b.r && a.g == b.g && a.b == b.b;
}

ReplicaPose pose(BodyId id, PrototypeId kind, RegionId owner) {
  ReplicaPose p;
  p.id = id;
  p.prototype = kind;
  p.owner = owner;
  p.position = {1, 2, 3};
  return p;
}

}  // namespace

TEST_CASE("Equal shapes share a mesh, and planes are the ground") {
  const WorldDefinition world = small_world();
  const SceneBuilder builder(world);
  REQUIRE(builder.meshes().size() == 4);  // capsule, sphere, box of crate and rock, wall
  REQUIRE(builder.statics().has_ground);
  REQUIRE(builder.statics().instances.size() == 1);
  REQUIRE(same(builder.statics().ground_colour, world.statics[0].colour));
}

TEST_CASE("Bodies are drawn where they are, under their ids, in their own colour") {
  const WorldDefinition world = small_world();
  const SceneBuilder builder(world);
  const std::vector<ReplicaPose> poses = {
      pose(BodyId::world(4), crate_kind, RegionId{1}),
      pose(BodyId::avatar(PlayerId{7}), avatar_kind, RegionId{0})};
  const render::Scene scene = builder.build(poses, false);
  REQUIRE(scene.instances.size() == 2);
  REQUIRE(scene.instances[0].sort_key == BodyId::world(4).value);
  REQUIRE(scene.instances[0].position == Eigen::Vector3f(1, 2, 3));
  REQUIRE(same(scene.instances[0].colour, world.prototypes[crate_kind.value].colour));
  REQUIRE(same(scene.instances[1].colour, player_colour(PlayerId{7})));
}

TEST_CASE("Tinted bodies differ by region, not by position") {
  const WorldDefinition world = small_world();
  const SceneBuilder builder(world);
  const std::vector<ReplicaPose> poses = {pose(BodyId::world(1), ball_kind, RegionId{0}),
                                          pose(BodyId::world(2), ball_kind, RegionId{1})};
  const auto plain = builder.build(poses, false), tinted = builder.build(poses, true);
  const auto same_rgb = [](render::Rgb a, render::Rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
  };
  REQUIRE(same_rgb(plain.instances[0].colour, plain.instances[1].colour));
  REQUIRE_FALSE(same_rgb(tinted.instances[0].colour, tinted.instances[1].colour));
}

TEST_CASE("Regions have colours that can be told apart") {
  for (std::uint16_t a = 0; a < 9; ++a)
    for (std::uint16_t b = 0; b < a; ++b) {
      const Colour x = region_colour(RegionId{a}), y = region_colour(RegionId{b});
      REQUIRE(std::abs(x.r - y.r) + std::abs(x.g - y.g) + std::abs(x.b - y.b) > 40);
    }
}

TEST_CASE("Boundaries are the edges that two regions share, within the world's bounds") {
  const WorldDefinition two = small_world();
  const auto line = boundary_lines(partition_of(two), two.bounds);
  REQUIRE(line.size() == 1);
  REQUIRE(line[0].from_xz == Eigen::Vector2f(0, -100));
  REQUIRE(line[0].to_xz == Eigen::Vector2f(0, 100));

  WorldDefinition t_shape = small_world();  // west is cut in two, east is whole
  Rectangle north_west = t_shape.regions[0].area, south_west = north_west;
  north_west.max_z = south_west.min_z = 10;
  t_shape.regions = {{"nw", north_west}, {"sw", south_west}, t_shape.regions[1]};
  REQUIRE(boundary_lines(partition_of(t_shape), t_shape.bounds).size() == 3);

  const Box3 west_only{{-100, -10, -100}, {-1, 100, 100}};
  REQUIRE(boundary_lines(partition_of(two), west_only).empty());
}

TEST_CASE("The eye is 0.2 m below the top of the avatar, and looks where the player looks") {
  const WorldDefinition world = small_world();
  const SceneBuilder builder(world);
  const auto camera = builder.avatar_camera(
      pose(BodyId::avatar(PlayerId{7}), avatar_kind, RegionId{0}), {0.5f, 0.1f});
  REQUIRE(camera.eye.x() == Approx(1));
  REQUIRE(camera.eye.y() == Approx(2 + 0.9 - 0.2));
  REQUIRE(camera.yaw_rad == 0.5f);
  REQUIRE(camera.pitch_rad == 0.1f);
}
