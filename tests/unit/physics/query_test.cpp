// Rays, spheres, who touches whom and who is carried.
#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

TEST_CASE("a ray meets the nearest body, or the next one if that is to be ignored") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> row{body(0, cube, 3, 0.5, 0), body(1, ball, 6, 0.5, 0)};
  world.add(row);
  const auto hit = world.raycast({0, 0.5, 0}, {10, 0.5, 0});
  REQUIRE(hit);
  CHECK(std::get<BodyId>(hit->what) == row[0].id);
  CHECK(hit->point.x == Approx(2.5).margin(0.01));
  CHECK(hit->normal.x() == Approx(-1).margin(1e-3));
  CHECK(hit->fraction == Approx(0.25).margin(1e-3));
  const auto behind = world.raycast({0, 0.5, 0}, {10, 0.5, 0}, row[0].id);
  REQUIRE(behind);
  CHECK(std::get<BodyId>(behind->what) == row[1].id);
  CHECK(behind->point.x == Approx(5.5).margin(0.01));
  CHECK(!world.raycast({0, 5, 0}, {10, 5, 0}));
}

TEST_CASE("a ray meets the ground exactly, also 10 km away, and only from above") {
  PhysicsWorld world = world_on_ground();
  const auto hit = world.raycast({0, 100, 0}, {10000, -100, 0});
  REQUIRE(hit);
  CHECK(std::get<StaticId>(hit->what) == StaticId{0});
  CHECK(hit->point.x == Approx(5000));
  CHECK(hit->point.y == Approx(0).margin(1e-4));
  CHECK(hit->normal == Eigen::Vector3f(0, 1, 0));
  CHECK(!world.raycast({0, -1, 0}, {0, 5, 0}));
}

TEST_CASE("a ray meets static geometry that stands in front of a body") {
  std::vector<StaticDefinition> table(2);
  table[1].shape = BoxShape{{0.5f, 2, 2}};
  table[1].position = {2, 0, 0};
  PhysicsWorld world(PhysicsSettings{}, prototypes(), table, 64);
  const NewBody hidden = body(0, ball, 5, 0.5, 0);
  world.add({&hidden, 1});
  const auto hit = world.raycast({0, 0.5, 0}, {10, 0.5, 0});
  REQUIRE(hit);
  CHECK(std::get<StaticId>(hit->what) == StaticId{1});
}

TEST_CASE("a sphere finds the bodies whose boxes it touches, sorted, moving or not") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> row;
  for (std::uint32_t i = 0; i < 10; ++i) row.push_back(body(i, cube, 2.0 * i, 0.5, 0));
  row[4].state.linear_velocity = {0, 40, 0};
  world.add(row);
  using Ids = std::vector<BodyId>;
  CHECK(world.overlapping_sphere({8, 0.5, 0}, 1.6f) ==
        Ids{BodyId::world(3), BodyId::world(4), BodyId::world(5)});
  world.step(tick_s);
  CHECK(world.overlapping_sphere({8, 0.2, 0}, 0.5f) == Ids{BodyId::world(4)});
  run(world, 3);
  CHECK(world.overlapping_sphere({8, 0.5, 0}, 1.6f) == Ids{BodyId::world(3), BodyId::world(5)});
}

TEST_CASE("a body is supported by what is below it and not by what leans on its side") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> bodies{body(0, cube, 0, 0.5, 0), body(1, cube, 0, 1.5, 0),
                              body(2, ball, 0, 8, 0), body(3, cube, 1.0, 0.5, 0)};
  world.add(bodies);
  run(world, 3);
  CHECK(world.is_supported(BodyId::world(0)));
  CHECK(world.is_supported(BodyId::world(1)));
  CHECK(!world.is_supported(BodyId::world(2)));
  CHECK(world.touching(BodyId::world(0)) ==
        std::vector<BodyId>{BodyId::world(1), BodyId::world(3)});
  CHECK(world.touching(BodyId::world(2)).empty());
}

TEST_CASE("a body that only leans against a wall in free fall is not supported") {
  std::vector<StaticDefinition> wall(1);
  wall[0].shape = BoxShape{{0.5f, 50, 50}};
  wall[0].position = {-0.995, 0, 0};
  PhysicsWorld world(PhysicsSettings{}, prototypes(), wall, 64);
  const NewBody leaning = body(0, cube, 0, 10, 0);
  world.add({&leaning, 1});
  run(world, 2);
  REQUIRE(!world.contacts_within(world.ids()).empty());
  CHECK(!world.is_supported(leaning.id));
}

TEST_CASE("statistics count pairs, manifolds and awake islands") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> two{body(0, cube, 0, 0.5, 0), body(1, cube, 9, 0.5, 0)};
  world.add(two);
  world.step(tick_s);
  CHECK(world.statistics().manifolds == 2);
  CHECK(world.statistics().pairs == 2);
  CHECK(world.statistics().islands == 2);
  run(world, 100);
  CHECK(world.statistics().islands == 0);
}

TEST_CASE("those of a group are found that are beside bodies outside of it") {
  PhysicsWorld world = world_on_ground();
  // Two with a gap of 3 cm, one 10 cm further, and one more in line with it.
  const std::vector<NewBody> row{body(0, cube, 0, 0.5, 0), body(1, cube, 1.03, 0.5, 0),
                                 body(2, cube, 2.13, 0.5, 0), body(3, cube, 3.13, 0.5, 0)};
  world.add(row);
  using Ids = std::vector<BodyId>;
  const auto beside = [&](const Ids& group) {
    Ids found{BodyId::world(99)};
    world.contacts_around(group, &found);
    return found;
  };
  const BodyId a = row[0].id, b = row[1].id, c = row[2].id, d = row[3].id;
  CHECK(world.touching(a).empty());
  CHECK(beside({a}) == Ids{a});
  CHECK(beside({a, b}).empty());
  CHECK(beside({c, b}) == Ids{b, c});
  CHECK(beside({a, b, c}) == Ids{c});
  CHECK(beside({a, b, c, d}).empty());
  // What does not move is nobody.
  world.turn_into_stand_ins({&b, 1});
  CHECK(beside({a}).empty());
}
