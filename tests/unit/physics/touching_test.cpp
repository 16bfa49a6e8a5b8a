// What is found by slots is what `touching` finds through the broadphase.
#include <algorithm>
#include <span>
#include <vector>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

struct Row {
  std::vector<BodyId> bodies;
  std::size_t leaning_on = 0;
};

/// What is found of a body; of others nothing.
Row whole_row(const PhysicsWorld& world, BodyId id) {
  if (!world.contains(id)) return {};
  std::vector<std::uint32_t> slots;
  Row found;
  found.leaning_on = world.find_touching(world.glance(id).slot(), slots);
  for (const std::uint32_t slot : slots) found.bodies.push_back(world.body_in_slot(slot));
  std::sort(found.bodies.begin(), found.bodies.end());
  return found;
}

std::vector<BodyId> row(const PhysicsWorld& world, BodyId id) {
  return whole_row(world, id).bodies;
}

std::size_t require_both_agree(const PhysicsWorld& world) {
  std::size_t joined = 0;
  for (const BodyId id : world.ids()) {
    const Row found = whole_row(world, id);
    std::vector<BodyId> touched = world.touching(id);
    const auto on_stand_ins =
        std::erase_if(touched, [&](BodyId other) { return world.is_stand_in(other); });
    REQUIRE(found.bodies == touched);
    // A compound stand-in may count more than once.
    REQUIRE(found.leaning_on - found.bodies.size() >= on_stand_ins);
    REQUIRE((on_stand_ins > 0 || found.leaning_on == found.bodies.size()));
    joined += found.bodies.size();
  }
  return joined;
}

}  // namespace

TEST_CASE(
    "what a body of a heap touches is found by its slot as by its name, awake, asleep and cut") {
  PhysicsWorld world = world_on_ground();
  world.add(heap(150, 33, 4));
  for (int i = 0; i < 5; ++i) {
    run(world, 20);
    require_both_agree(world);
  }
  CHECK(require_both_agree(world) > 150);
  for (int i = 0; i < 1500 && world.awake_count() > 0; ++i) world.step(tick_s);
  CHECK(world.awake_count() < 10);
  CHECK(require_both_agree(world) > 150);

  const std::vector<BodyId> cut(world.ids().begin() + 20, world.ids().begin() + 60);
  world.turn_into_stand_ins(cut);
  REQUIRE(world.size() == 110);
  std::size_t on_stand_ins = 0;
  for (const BodyId id : world.ids()) {
    const Row found = whole_row(world, id);
    on_stand_ins += found.leaning_on - found.bodies.size();
  }
  CHECK(on_stand_ins > 10);
  for (const BodyId id : cut) CHECK(row(world, id).empty());
  require_both_agree(world);
}

TEST_CASE("what sleepers touch that arrive with their contacts is found by their slots") {
  PhysicsWorld from = world_on_ground();
  from.add(pyramid());
  run(from, 400);
  REQUIRE(from.awake_count() == 0);
  PhysicsWorld to = world_on_ground();
  to.add(bodies_of(from));
  REQUIRE(row(to, BodyId::world(0)).empty());
  to.install_contacts(from.contacts_within(from.ids()));
  CHECK(require_both_agree(to) > 0);
  for (BodyId id : from.ids()) CHECK(row(to, id) == row(from, id));
}

TEST_CASE("who has left is not found any more") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> tower = plain_tower();
  world.add(std::span(tower).first(3));
  CHECK(row(world, BodyId::world(0)).empty());
  run(world, 3);
  CHECK(row(world, BodyId::world(1)) == std::vector<BodyId>{BodyId::world(0), BodyId::world(2)});
  const BodyId top = BodyId::world(2);
  world.remove({&top, 1});
  CHECK(row(world, BodyId::world(1)) == std::vector<BodyId>{BodyId::world(0)});
  CHECK(row(world, top).empty());
}
