// The list of those that are awake, which a step leaves behind and everything else must not spoil.
#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

/// Whether awake() says of every body what is_asleep() and state() say.
bool names_exactly_those_awake(const PhysicsWorld& world) {
  const std::span<const NewBody> awake = world.awake();
  std::size_t at = 0;
  for (BodyId id : world.ids()) {
    if (world.is_asleep(id)) continue;
    if (at == awake.size() || awake[at].id != id) return false;
    if (awake[at].prototype != world.prototype(id)) return false;
    if (!identical(awake[at].state, world.state(id))) return false;
    ++at;
  }
  return at == awake.size() && at == world.awake_count();
}

}  // namespace

TEST_CASE("those that are awake are named as they are after every step, until all sleep") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> tower = plain_tower();
  NewBody high = body(100, ball, 8, 6, 0);
  tower.push_back(high);
  world.add(tower);
  REQUIRE(names_exactly_those_awake(world));
  bool mixed = false;
  for (int i = 0; i < 1500 && world.awake_count() > 0; ++i) {
    world.step(tick_s);
    REQUIRE(names_exactly_those_awake(world));
    mixed = mixed || (!world.awake().empty() && world.awake().size() < world.size());
  }
  CHECK(mixed);
  CHECK(world.awake().empty());
}

TEST_CASE("whatever wakes, moves, adds or removes bodies, those that are awake are named at once") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> row;
  for (std::uint32_t n = 0; n < 12; ++n) {
    row.push_back(body(n, cube, 3.0 * n, 0.5, 0));
    row.back().state.activation = n % 2 == 0 ? Activation::asleep : Activation::awake;
  }
  world.add(row);
  world.step(tick_s);
  REQUIRE(names_exactly_those_awake(world));
  const auto id = [](std::uint32_t n) { return BodyId::world(n); };
  world.wake(id(0));
  CHECK(names_exactly_those_awake(world));
  CHECK(world.awake().front().id == id(0));
  world.apply_impulse(id(2), {0, 5, 0});
  CHECK(names_exactly_those_awake(world));
  world.apply_force(id(4), {0, 5, 0});
  CHECK(names_exactly_those_awake(world));
  world.set_velocity(id(6), {1, 0, 0}, {0, 1, 0});
  CHECK(names_exactly_those_awake(world));
  CHECK(world.awake().size() == 10);
  BodyState still = world.state(id(1));
  still.activation = Activation::asleep;
  still.position.x += 0.5;
  world.set_state(id(1), still);
  CHECK(names_exactly_those_awake(world));
  world.turn_into_stand_ins(std::vector{id(3)});
  CHECK(names_exactly_those_awake(world));
  world.remove(std::vector{id(5), id(8)});
  CHECK(names_exactly_those_awake(world));
  world.add(std::vector{body(30, ball, -5, 3, 0), row[3]});
  CHECK(names_exactly_those_awake(world));
  CHECK(world.awake().back().id == id(30));
  world.step(tick_s);
  CHECK(names_exactly_those_awake(world));
}
