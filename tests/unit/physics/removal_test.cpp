// Bodies leave with everything that belongs to them, and those they carried notice.
#include <algorithm>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

TEST_CASE("removing a support wakes what rested on it and it falls") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> tower = plain_tower();
  world.add(std::span(tower).first(3));
  run(world, 150);
  REQUIRE(world.awake_count() == 0);
  const BodyId lowest = tower[0].id;
  world.remove({&lowest, 1});
  CHECK(!world.is_asleep(tower[1].id));
  CHECK(world.is_asleep(tower[2].id));  // did not touch it; its island wakes it in the step
  run(world, 150);
  CHECK(world.position(tower[1].id).y == Approx(0.5).margin(0.02));
  CHECK(world.position(tower[2].id).y == Approx(1.5).margin(0.02));
}

TEST_CASE("removing a support wakes what arrived on it asleep and was never looked at") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> tower = plain_tower();
  for (NewBody& b : tower) b.state.activation = Activation::asleep;
  world.add(tower);
  run(world, 10);
  world.remove({&tower[0].id, 1});
  CHECK(!world.is_asleep(tower[1].id));
}

TEST_CASE("removing a body wakes nobody who did not touch it") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> apart{body(0, cube, 0, 0.5, 0), body(1, cube, 1.5, 0.5, 0)};
  world.add(apart);
  run(world, 100);
  REQUIRE(world.awake_count() == 0);
  world.remove({&apart[0].id, 1});
  CHECK(world.awake_count() == 0);
}

TEST_CASE("a sixth of a heap leaves, and nothing in the world refers to it any more") {
  PhysicsWorld world(PhysicsSettings{}, prototypes(), ground(), 4096);
  world.add(heap(3000, 11, 16));
  run(world, 25);
  std::vector<BodyId> leaving;
  for (std::size_t i = 0; i < world.size(); i += 6) leaving.push_back(world.ids()[i]);
  REQUIRE(leaving.size() == 500);
  std::vector<std::pair<BodyId, BodyState>> staying;
  for (BodyId id : world.ids())
    if (!std::binary_search(leaving.begin(), leaving.end(), id))
      staying.emplace_back(id, world.state(id));

  world.remove(leaving);
  REQUIRE(world.size() == 2500);
  REQUIRE(std::is_sorted(world.ids().begin(), world.ids().end()));
  for (const auto& [id, state] : staying) REQUIRE(identical(world.state(id), state));
  for (BodyId id : leaving) REQUIRE(!world.contains(id));
  const auto gone = [&](BodyId id) { return !world.contains(id); };
  const auto no_trace = [&] {
    for (const ContactManifold& c : world.contacts_within(world.ids())) {
      if (gone(c.a)) return false;
      if (const BodyId* b = std::get_if<BodyId>(&c.b); b && gone(*b)) return false;
    }
    const auto found = world.overlapping_sphere({10, 5, 10}, 100);
    return found == ids_of(world);
  };
  REQUIRE(no_trace());
  run(world, 5);
  REQUIRE(no_trace());
}

TEST_CASE("a world that is emptied holds no pair, and can be filled again") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> bodies = heap(100, 12);
  world.add(bodies);
  run(world, 60);
  world.remove(ids_of(world));
  CHECK(world.size() == 0);
  CHECK(world.statistics().pairs == 0);
  CHECK(world.statistics().manifolds == 0);
  run(world, 3);
  world.add(bodies);
  run(world, 60);
  CHECK(world.size() == 100);
}

TEST_CASE("an obstacle can be removed like any body") {
  PhysicsWorld world = world_on_ground();
  const NewBody lower = body(0, cube, 0, 0.5, 0);
  const NewBody upper = body(1, ball, 0, 1.5, 0);
  world.add_obstacle(lower);
  world.add({&upper, 1});
  run(world, 10);
  world.remove({&lower.id, 1});
  run(world, 60);
  CHECK(world.position(upper.id).y == Approx(0.5).margin(0.02));
}
