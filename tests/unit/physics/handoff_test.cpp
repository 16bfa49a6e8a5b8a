// Stacks change their world, with and without their contacts.
#include <algorithm>
#include <map>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

enum class Carry { poses, contacts };

/// Something already lives in the receiving world, so that nothing lines up by accident.
PhysicsWorld receiving_world() {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> others = heap(30, 5);
  for (NewBody& b : others) {
    b.id = BodyId::world(static_cast<std::uint32_t>(1000 + (&b - others.data())));
    b.state.position.x += 50;
  }
  world.add(others);
  run(world, 40);
  return world;
}

void move_all(const PhysicsWorld& from, PhysicsWorld& to, Carry carry) {
  const std::vector<NewBody> bodies = bodies_of(from);
  to.add(bodies);
  if (carry == Carry::contacts) to.install_contacts(from.contacts_within(from.ids()));
}

/// The farthest that a body of `stays` is from the same body in `moved` (unit: m).
double deviation(const PhysicsWorld& stays, const PhysicsWorld& moved) {
  double worst = 0;
  for (BodyId id : stays.ids())
    worst = std::max(worst, distance(stays.position(id), moved.position(id)));
  return worst;
}

/// Settles a stack for `before` ticks, moves it, and says how far it strays within 2 s.
double strays(const std::vector<NewBody>& stack, int before, Carry carry) {
  PhysicsWorld stays = world_on_ground();
  stays.add(stack);
  run(stays, before);
  REQUIRE(stays.awake_count() == stack.size());
  PhysicsWorld moved = receiving_world();
  move_all(stays, moved, carry);
  double worst = 0;
  for (int i = 0; i < 125; ++i) {
    stays.step(tick_s);
    moved.step(tick_s);
    worst = std::max(worst, deviation(stays, moved));
  }
  return worst;
}

/// The same stack with its ids the other way round, as seen by a world where it came in two parts:
/// who is Bullet's first body differs from the world that it comes from.
void move_in_two_parts(const PhysicsWorld& from, PhysicsWorld& to) {
  const std::vector<NewBody> bodies = bodies_of(from);
  for (auto b = bodies.rbegin(); b != bodies.rend(); ++b) to.add({&*b, 1});
  to.install_contacts(from.contacts_within(from.ids()));
}

bool same_points(const ContactPoint& x, const ContactPoint& y) {
  return x.local_on_a == y.local_on_a && x.local_on_b == y.local_on_b &&
         x.normal_on_b == y.normal_on_b && x.distance == y.distance && x.impulse == y.impulse &&
         x.impulse_lateral_1 == y.impulse_lateral_1 && x.impulse_lateral_2 == y.impulse_lateral_2 &&
         x.lateral_1 == y.lateral_1 && x.lateral_2 == y.lateral_2 && x.age_steps == y.age_steps &&
         x.child_a == y.child_a && x.child_b == y.child_b;
}

void require_same(std::vector<ContactManifold> x, std::vector<ContactManifold> y) {
  REQUIRE(x.size() == y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    REQUIRE(x[i].a == y[i].a);
    REQUIRE(x[i].b == y[i].b);
    REQUIRE(x[i].points.size() == y[i].points.size());
    for (std::size_t p = 0; p < x[i].points.size(); ++p)
      REQUIRE(same_points(x[i].points[p], y[i].points[p]));
  }
}

}  // namespace

// The group comes whole and in the order of its ids: its pairs then stand in the order that they
// had, and measured not a bit differs. The limits leave room for another build of Bullet.
TEST_CASE("a pyramid that changes its world with its contacts does not notice") {
  const double with = strays(pyramid(), 15, Carry::contacts);
  const double without = strays(pyramid(), 15, Carry::poses);
  INFO("with contacts " << with * 1e3 << " mm, without " << without * 1e3 << " mm");
  CHECK(with < 1e-5);
  CHECK(without > 1e-3);
}

TEST_CASE("towers that change their world with their contacts stray by less than 5 mm") {
  for (const auto& tower : {plain_tower(), careless_tower(), crossed_tower()}) {
    const double with = strays(tower, 15, Carry::contacts);
    const double without = strays(tower, 15, Carry::poses);
    INFO("with contacts " << with * 1e3 << " mm, without " << without * 1e3 << " mm");
    CHECK(with < 5e-3);
    CHECK(without > 1e-3);
  }
}

TEST_CASE("a sleeping stack changes its world without moving by one bit and sleeps on") {
  for (const auto& stack : {pyramid(), plain_tower(), crossed_tower()}) {
    PhysicsWorld stays = world_on_ground();
    stays.add(stack);
    run(stays, 400);
    REQUIRE(stays.awake_count() == 0);
    PhysicsWorld moved = world_on_ground();
    move_all(stays, moved, Carry::contacts);
    CHECK(moved.state_hash() == stays.state_hash());
    run(moved, 125);
    CHECK(moved.awake_count() == 0);
    CHECK(moved.state_hash() == stays.state_hash());
    CHECK(moved.touching(stack[0].id) == stays.touching(stack[0].id));
    require_same(moved.contacts_within(moved.ids()), stays.contacts_within(stays.ids()));
  }
}

TEST_CASE("contacts of every shape arrive as they left, whichever body Bullet puts first") {
  PhysicsWorld from = world_on_ground();
  from.add(heap(120, 21, 4));
  run(from, 90);
  const auto sent = from.contacts_within(from.ids());
  REQUIRE(sent.size() > 100);
  PhysicsWorld same_order = world_on_ground();
  move_all(from, same_order, Carry::contacts);
  PhysicsWorld other_order = world_on_ground();
  move_in_two_parts(from, other_order);

  for (const PhysicsWorld* to : {&same_order, &other_order}) {
    using Key = std::tuple<BodyId, ContactPartner, std::int16_t, std::int16_t>;
    std::map<Key, const ContactManifold*> arrived;
    const auto received = to->contacts_within(to->ids());
    for (const auto& c : received)
      arrived[{c.a, c.b, c.points[0].child_a, c.points[0].child_b}] = &c;
    std::size_t same = 0;
    for (const auto& c : sent) {
      const auto found = arrived.find({c.a, c.b, c.points[0].child_a, c.points[0].child_b});
      if (found == arrived.end() || found->second->points.size() != c.points.size()) continue;
      bool all = true;
      for (std::size_t p = 0; p < c.points.size(); ++p)
        all &= same_points(c.points[p], found->second->points[p]);
      same += all;
    }
    // Bodies have moved for one step since Bullet looked: a pair or two have parted already.
    INFO(same << " of " << sent.size());
    CHECK(same + 2 >= sent.size());
  }
}

TEST_CASE("a tower whose bodies come in another order still stands where it stood") {
  PhysicsWorld stays = world_on_ground();
  stays.add(pyramid());
  run(stays, 15);
  PhysicsWorld moved = world_on_ground();
  move_in_two_parts(stays, moved);
  run(stays, 125);
  run(moved, 125);
  // The solver now meets the contacts in another order, which costs tenths of a millimetre.
  CHECK(deviation(stays, moved) < 1e-3);
}

TEST_CASE("tables and hulls on top of each other change their world together") {
  std::vector<NewBody> stack{body(0, compound, 0, 0.45, 0), body(1, compound, 0, 1.35, 0),
                             body(2, hull, 0, 2.2, 0), body(3, hull, 3, 0.4, 0),
                             body(4, cube, 3, 1.3, 0)};
  CHECK(strays(stack, 15, Carry::contacts) < 1e-3);
}

TEST_CASE("contacts with bodies that are not here are left out") {
  PhysicsWorld from = world_on_ground();
  const std::vector<NewBody> tower = plain_tower();
  from.add(tower);
  run(from, 15);
  const auto sent = from.contacts_within(from.ids());
  PhysicsWorld to = world_on_ground();
  const auto state = from.state(tower[0].id);
  const NewBody lowest{tower[0].id, tower[0].prototype, state};
  to.add({&lowest, 1});
  to.install_contacts(sent);
  const auto received = to.contacts_within(to.ids());
  REQUIRE(received.size() == 1);
  CHECK(std::get<StaticId>(received[0].b) == StaticId{0});
  run(to, 10);
}

TEST_CASE("a scratch world shares shapes and gives what a world of its own would give") {
  PhysicsWorld owner = world_on_ground();
  owner.add(heap(40, 31));
  run(owner, 50);
  PhysicsWorld own = world_on_ground();
  PhysicsWorld scratch = owner.scratch();
  move_all(owner, own, Carry::contacts);
  move_all(owner, scratch, Carry::contacts);
  const auto before = owner.state_hash();
  for (int i = 0; i < 30; ++i) {
    own.step(tick_s);
    scratch.step(tick_s);
    REQUIRE(own.state_hash() == scratch.state_hash());
  }
  CHECK(owner.state_hash() == before);
}
