// Resting bodies of another server, as immovable copies that ours lean on.
#include <algorithm>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

std::vector<BodyId> ids_in(std::span<const NewBody> bodies) {
  std::vector<BodyId> out;
  for (const NewBody& b : bodies) out.push_back(b.id);
  return out;
}

/// Five cubes on top of each other that have settled for `ticks`.
PhysicsWorld stack_of_five(int ticks) {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> tower = plain_tower();
  world.add(std::span(tower).first(5));
  run(world, ticks);
  return world;
}

const std::vector<BodyId> lower_two{BodyId::world(0), BodyId::world(1)};
const std::vector<BodyId> upper_three{BodyId::world(2), BodyId::world(3), BodyId::world(4)};

WorldPosition place_of(const PhysicsWorld& world, BodyId id) {
  return world.is_stand_in(id) ? world.stand_in(id).state.position : world.position(id);
}

/// The farthest that anybody is from where they are in `stays` (m).
double deviation(const PhysicsWorld& stays, const PhysicsWorld& other) {
  double worst = 0;
  for (BodyId id : stays.ids())
    worst = std::max(worst, distance(stays.position(id), place_of(other, id)));
  return worst;
}

double deviation_within(PhysicsWorld& stays, PhysicsWorld& other, int ticks) {
  double worst = 0;
  for (int i = 0; i < ticks; ++i) {
    stays.step(tick_s);
    other.step(tick_s);
    worst = std::max(worst, deviation(stays, other));
  }
  return worst;
}

std::vector<NewBody> back_to_life(const PhysicsWorld& world, const PhysicsWorld& owner) {
  std::vector<NewBody> out;
  for (BodyId id : world.stand_in_ids()) out.push_back({id, owner.prototype(id), owner.state(id)});
  return out;
}

}  // namespace

TEST_CASE("the lower two of a sleeping stack become stand-ins: nobody wakes and nothing moves") {
  PhysicsWorld stays = stack_of_five(400);
  PhysicsWorld cut = stack_of_five(400);
  REQUIRE(cut.awake_count() == 0);
  const auto contacts = cut.contacts_around(upper_three);
  cut.turn_into_stand_ins(lower_two);
  CHECK(cut.awake_count() == 0);
  CHECK(cut.touching(upper_three[0]) == std::vector<BodyId>{lower_two[1], upper_three[1]});
  const auto kept = cut.contacts_around(upper_three);
  REQUIRE(kept.size() == contacts.size());
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t p = 0; p < kept[i].points.size(); ++p)
      CHECK(kept[i].points[p].impulse == contacts[i].points[p].impulse);
  run(cut, 125);
  CHECK(cut.awake_count() == 0);
  CHECK(deviation(stays, cut) == 0);

  cut.add(back_to_life(cut, stays));
  CHECK(cut.awake_count() == 0);
  CHECK(cut.state_hash() == stays.state_hash());
  run(cut, 125);
  CHECK(cut.state_hash() == stays.state_hash());
}

TEST_CASE("an awake stack stands on stand-ins as on bodies, and again when they come to life") {
  // The careless tower still trembles when its lower part stops dead: its top strays by 3.6 mm.
  const std::pair<std::vector<NewBody>, double> towers[] = {{plain_tower(), 1e-3},
                                                            {careless_tower(), 5e-3}};
  for (const auto& [tower, limit] : towers) {
    PhysicsWorld stays = world_on_ground();
    PhysicsWorld cut = world_on_ground();
    stays.add(std::span(tower).first(5));
    cut.add(std::span(tower).first(5));
    // Contacts have settled; nobody sleeps yet.
    for (PhysicsWorld* world : {&stays, &cut}) {
      for (int i = 0; i < 90; ++i) {
        for (BodyId id : world->ids()) world->wake(id);
        world->step(tick_s);
      }
    }
    REQUIRE(cut.awake_count() == 5);
    cut.turn_into_stand_ins(lower_two);
    CHECK(cut.awake_count() == 3);
    CHECK(deviation_within(stays, cut, 125) < limit);

    std::vector<NewBody> lower = back_to_life(cut, stays);
    for (NewBody& b : lower) b.state.activation = Activation::awake;
    cut.add(lower);
    CHECK(cut.stand_in_ids().empty());
    CHECK(cut.awake_count() == 2 + std::size_t(!cut.is_asleep(upper_three[0])) * 3);
    CHECK(deviation_within(stays, cut, 125) < limit);
  }
}

TEST_CASE("without the impulses of its contacts a tower that goes back to bodies would move") {
  PhysicsWorld stays = world_on_ground();
  stays.add(careless_tower());
  run(stays, 15);
  const auto moved_by = [&](bool contacts) {
    PhysicsWorld owner = world_on_ground();
    owner.add(careless_tower());
    run(owner, 15);
    PhysicsWorld cut = world_on_ground();
    cut.add(careless_tower());
    run(cut, 15);
    cut.turn_into_stand_ins(lower_two);
    if (!contacts) {
      std::vector<NewBody> bare = back_to_life(cut, owner);
      cut.remove_stand_ins(lower_two, Wake::nobody);
      cut.add_stand_ins(bare);
    }
    cut.add(back_to_life(cut, owner));
    cut.install_contacts(owner.contacts_within(lower_two));
    return deviation_within(owner, cut, 60);
  };
  const double with = moved_by(true);
  const double without = moved_by(false);
  INFO("with contacts " << with * 1e3 << " mm, without " << without * 1e3 << " mm");
  CHECK(with < 1e-3);
  CHECK(without > 2 * with);
}

TEST_CASE("a stand-in is in no list of bodies") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> two{body(0, cube, 0, 0.5, 0), body(1, cube, 4, 0.5, 0)};
  world.add({&two[0], 1});
  const auto before = world.state_hash();
  world.add_stand_ins({&two[1], 1});
  CHECK(world.size() == 1);
  CHECK(ids_of(world) == ids_in({&two[0], 1}));
  CHECK(!world.contains(two[1].id));
  CHECK(world.awake_count() == 1);
  CHECK(world.state_hash() == before);
  CHECK(world.overlapping_sphere({2, 0.5, 0}, 10) == ids_in({&two[0], 1}));
  CHECK(world.is_stand_in(two[1].id));
  CHECK(!world.is_stand_in(two[0].id));
  CHECK(std::vector<BodyId>(world.stand_in_ids().begin(), world.stand_in_ids().end()) ==
        ids_in({&two[1], 1}));
  CHECK(world.stand_in(two[1].id).state.position == two[1].state.position);
  CHECK(world.stand_in(two[1].id).prototype == two[1].prototype);
}

TEST_CASE("a ray points at a stand-in by its id, or passes it") {
  PhysicsWorld world = world_on_ground();
  const NewBody one = body(7, cube, 3, 0.5, 0);
  world.add_stand_ins({&one, 1});
  const auto hit = world.raycast({0, 0.5, 0}, {10, 0.5, 0});
  REQUIRE(hit);
  CHECK(std::get<BodyId>(hit->what) == one.id);
  CHECK(!world.raycast({0, 0.5, 0}, {10, 0.5, 0}, one.id));
}

TEST_CASE("a ball dropped on a stand-in bounces as on the ground, and its load is told") {
  std::vector<BodyDefinition> table(2);
  table[0].restitution = 0.8f;
  table[0].linear_damping = 0;
  table[1].shape = BoxShape{{0.5f, 0.5f, 0.5f}};
  table[1].restitution = 1.0f;
  table[1].mass_kg = 0.01f;
  PhysicsWorld world(PhysicsSettings{}, table, {}, 64);
  const NewBody below = body(0, 1, 0, 0.5, 0);
  const NewBody dropped = body(1, 0, 0, 4.5, 0);
  world.add_stand_ins({&below, 1});
  world.add({&dropped, 1});
  double top = 0;
  float hardest = 0;
  bool hit = false;
  std::vector<StandInLoad> loads;
  for (int i = 0; i < 120; ++i) {
    world.step(tick_s);
    loads.clear();
    world.stand_in_loads(loads);
    for (const StandInLoad& load : loads) {
      CHECK(load.stand_in == below.id);
      CHECK(load.body == dropped.id);
      hardest = std::max(hardest, load.impulse_ns);
    }
    const BodyState s = world.state(dropped.id);
    hit |= s.linear_velocity.y() > 1;
    if (hit) top = std::max(top, s.position.y - 1.5);
  }
  CHECK(top == Approx(3 * 0.8 * 0.8).margin(0.2));
  // 1 kg that comes with 7.7 m/s and leaves with eight tenths of it.
  CHECK(hardest == Approx(7.7 * 1.8).margin(1));
  CHECK(world.stand_in(below.id).state.position == below.state.position);
}

TEST_CASE("what rests on a stand-in presses on it with its weight, until it sleeps") {
  PhysicsWorld world = world_on_ground();
  const NewBody below = body(1, cube, 0, 0.5, 0);
  const std::vector<NewBody> above{body(0, compound, -0.2, 1.45, 0), body(2, ball, 9, 0.5, 0)};
  world.add_stand_ins({&below, 1});
  world.add(above);
  run(world, 15);
  std::vector<StandInLoad> loads;
  world.stand_in_loads(loads);
  REQUIRE(loads.size() == 1);
  CHECK(loads[0].body == above[0].id);
  world.set_state(above[0].id, [&] {
    BodyState s = world.state(above[0].id);
    s.position = {0, 1.46, 0};
    s.orientation.setIdentity();
    return s;
  }());
  run(world, 200);
  CHECK(world.is_asleep(above[0].id));
  loads.clear();
  world.stand_in_loads(loads);
  CHECK(loads.empty());
  world.wake(above[0].id);
  run(world, 2);
  world.stand_in_loads(loads);
  REQUIRE(loads.size() == 1);
  CHECK(loads[0].impulse_ns == Approx(9.81 * tick_s).epsilon(0.1));
}

TEST_CASE("a stand-in that leaves lets what stood on it fall, or sleep on if nobody is to wake") {
  for (const Wake wake : {Wake::touching, Wake::nobody}) {
    PhysicsWorld world = stack_of_five(400);
    world.turn_into_stand_ins(lower_two);
    REQUIRE(world.awake_count() == 0);
    world.remove_stand_ins(lower_two, wake);
    CHECK(world.stand_in_ids().empty());
    CHECK(world.awake_count() == (wake == Wake::touching ? 1 : 0));
    run(world, 150);
    const double y = wake == Wake::touching ? 0.5 : 2.5;
    CHECK(world.position(upper_three[0]).y == Approx(y).margin(0.02));
  }
}

TEST_CASE("a body that leaves with nobody to be woken leaves sleepers asleep") {
  PhysicsWorld world = stack_of_five(400);
  world.remove(lower_two, Wake::nobody);
  CHECK(world.awake_count() == 0);
  run(world, 50);
  CHECK(world.awake_count() == 0);
  CHECK(world.position(upper_three[0]).y == Approx(2.5).margin(0.02));
}

TEST_CASE("a stand-in put beside a sleeper touches it at once and wakes it only by leaving") {
  PhysicsWorld world = world_on_ground();
  NewBody sleeper = body(5, cube, 0, 1.499, 0);
  sleeper.state.activation = Activation::asleep;
  const NewBody below = body(9, cube, 0, 0.5, 0);
  world.add({&sleeper, 1});
  world.add_stand_ins({&below, 1});
  CHECK(world.is_asleep(sleeper.id));
  CHECK(world.touching(sleeper.id) == std::vector<BodyId>{below.id});
  const auto contacts = world.contacts_around({&below.id, 1});
  REQUIRE(contacts.size() == 1);
  CHECK(contacts[0].a == sleeper.id);
  CHECK(std::get<BodyId>(contacts[0].b) == below.id);
  CHECK(contacts[0].points[0].normal_on_b.y() == Approx(1));
  run(world, 20);
  CHECK(world.is_asleep(sleeper.id));
  NewBody aside = below;
  aside.state.position.x = 30;
  world.add_stand_ins({&aside, 1});
  CHECK(world.is_asleep(sleeper.id));
  CHECK(world.touching(sleeper.id).empty());
  std::vector<std::uint32_t> touched;
  CHECK(world.find_touching(world.glance(sleeper.id).slot(), touched) == 0);
}

TEST_CASE("contacts with a stand-in change their world and come back") {
  PhysicsWorld owner = stack_of_five(400);
  PhysicsWorld other = world_on_ground();
  std::vector<NewBody> upper, lower;
  for (BodyId id : upper_three) upper.push_back({id, owner.prototype(id), owner.state(id)});
  for (BodyId id : lower_two) lower.push_back({id, owner.prototype(id), owner.state(id)});
  const auto sent = owner.contacts_around(upper_three);
  other.add_stand_ins(lower);
  other.add(upper);
  other.install_contacts(sent);
  CHECK(other.awake_count() == 0);
  const auto arrived = other.contacts_around(upper_three);
  REQUIRE(arrived.size() == sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    CHECK(arrived[i].a == sent[i].a);
    CHECK(arrived[i].b == sent[i].b);
    REQUIRE(arrived[i].points.size() == sent[i].points.size());
    for (std::size_t p = 0; p < sent[i].points.size(); ++p) {
      CHECK(arrived[i].points[p].impulse == sent[i].points[p].impulse);
      CHECK(arrived[i].points[p].normal_on_b == sent[i].points[p].normal_on_b);
    }
  }
}

TEST_CASE("stand-ins come to life elsewhere too: their old contacts are gone then") {
  PhysicsWorld world = stack_of_five(400);
  world.turn_into_stand_ins(lower_two);
  NewBody far = world.stand_in(lower_two[1]);
  far.state.position.x += 5;
  far.state.activation = Activation::awake;
  world.add({&far, 1});
  CHECK(world.awake_count() == 1);
  CHECK(world.contains(far.id));
  CHECK(world.position(far.id).x == Approx(5).margin(1e-3));
  CHECK(world.touching(upper_three[0]) == std::vector<BodyId>{upper_three[1]});
  run(world, 100);
  CHECK(world.position(far.id).y == Approx(0.5).margin(0.02));
}

TEST_CASE("two equal runs with stand-ins agree bit for bit") {
  PhysicsWorld one = world_on_ground();
  PhysicsWorld two = world_on_ground();
  std::vector<NewBody> bodies = heap(120, 17, 4);
  for (PhysicsWorld* world : {&one, &two}) {
    world->add(bodies);
    std::shuffle(bodies.begin(), bodies.end(), std::mt19937(3));
    run(*world, 100);
  }
  REQUIRE(one.state_hash() == two.state_hash());
  std::vector<BodyId> resting(one.ids().begin(), one.ids().begin() + 30);
  one.turn_into_stand_ins(resting);
  std::reverse(resting.begin(), resting.end());
  two.turn_into_stand_ins(resting);
  for (int i = 0; i < 100; ++i) {
    one.step(tick_s);
    two.step(tick_s);
    REQUIRE(one.state_hash() == two.state_hash());
    std::vector<StandInLoad> x, y;
    one.stand_in_loads(x);
    two.stand_in_loads(y);
    REQUIRE(x == y);
  }
  std::vector<NewBody> back;
  for (BodyId id : one.stand_in_ids()) back.push_back(one.stand_in(id));
  one.add(back);
  std::reverse(back.begin(), back.end());
  two.add(back);
  for (int i = 0; i < 60; ++i) {
    one.step(tick_s);
    two.step(tick_s);
    REQUIRE(one.state_hash() == two.state_hash());
  }
}
