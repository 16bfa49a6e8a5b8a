// The same calls give the same bits, step by step.
#include <algorithm>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {
void require_same_for(PhysicsWorld& one, PhysicsWorld& two, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    one.step(tick_s);
    two.step(tick_s);
    REQUIRE(one.state_hash() == two.state_hash());
  }
}
}  // namespace

TEST_CASE("two worlds with the same calls agree bit for bit in every step of a falling heap") {
  PhysicsWorld one = world_on_ground();
  PhysicsWorld two = world_on_ground();
  const std::vector<NewBody> bodies = heap(200, 7);
  one.add(bodies);
  two.add(bodies);
  require_same_for(one, two, 150);
  const std::vector<BodyId> some{one.ids()[3], one.ids()[50], one.ids()[120]};
  one.remove(some);
  two.remove(some);
  require_same_for(one, two, 100);
  for (BodyId id : one.ids()) REQUIRE(identical(one.state(id), two.state(id)));
}

TEST_CASE("the order of bodies within one call does not matter to a single bit") {
  PhysicsWorld one = world_on_ground();
  PhysicsWorld two = world_on_ground();
  std::vector<NewBody> bodies = heap(200, 8);
  one.add(bodies);
  std::shuffle(bodies.begin(), bodies.end(), std::mt19937(1));
  two.add(bodies);
  require_same_for(one, two, 100);
  std::vector<BodyId> leaving(one.ids().begin() + 20, one.ids().begin() + 60);
  one.remove(leaving);
  std::reverse(leaving.begin(), leaving.end());
  two.remove(leaving);
  require_same_for(one, two, 100);
}

TEST_CASE("reading a world changes nothing in it") {
  PhysicsWorld read = world_on_ground();
  PhysicsWorld left_alone = world_on_ground();
  const std::vector<NewBody> bodies = heap(60, 9);
  read.add(bodies);
  left_alone.add(bodies);
  std::vector<std::uint32_t> touched;
  for (int i = 0; i < 100; ++i) {
    read.step(tick_s);
    left_alone.step(tick_s);
    read.contacts_within(ids_of(read));
    read.touching(read.ids()[5]);
    read.find_touching(read.glance(read.ids()[5]).slot(), touched);
    read.contacts_around(std::span(read.ids()).first(9));
    read.is_supported(read.ids()[6]);
    read.raycast({-5, 3, 0}, {20, 0, 5});
    read.overlapping_sphere({2, 2, 2}, 3);
    read.awake_count();
    read.statistics();
    REQUIRE(read.state_hash() == left_alone.state_hash());
  }
}

TEST_CASE("the state hash notices the last bit of one number") {
  PhysicsWorld one = world_on_ground();
  PhysicsWorld two = world_on_ground();
  NewBody b = body(0, ball, 1, 5, 1);
  one.add({&b, 1});
  b.state.linear_velocity.x() = std::nextafter(0.0f, 1.0f);
  two.add({&b, 1});
  CHECK(one.state_hash() != two.state_hash());
}
