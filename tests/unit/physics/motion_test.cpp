// How one body moves: against closed forms of Bullet's integrator, and when it sleeps.
#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

TEST_CASE("a falling body follows the integrator's closed form") {
  std::vector<BodyDefinition> table(1);
  table[0].linear_damping = 0.1f;
  const PhysicsSettings settings;
  PhysicsWorld world(settings, table, {}, 64);
  NewBody falling = body(0, 0, 0, 100, 0);
  falling.state.linear_velocity = {3, 0, 0};
  world.add({&falling, 1});
  // Each step: v <- v (1 - d)^dt + g dt, then x <- x + v dt. Summed up over n steps with
  // r = (1 - d)^dt: v_n = r^n v_0 + g dt (1 - r^n) / (1 - r), and x_n is the sum of these.
  const double dt = tick_s;
  const double r = std::pow(1 - 0.1, dt);
  const int n = 125;
  run(world, n);
  const double rn = std::pow(r, n);
  const double gain = (1 - rn) / (1 - r);
  const double x = 3 * dt * r * gain;
  const double vy = settings.gravity.y() * dt * gain;
  const double y = 100 + settings.gravity.y() * dt * dt * (n - r * gain) / (1 - r);
  const BodyState state = world.state(falling.id);
  // 125 roundings of floats near 100 add up to less than a millimetre.
  CHECK(state.position.x == Approx(x).margin(1e-4));
  CHECK(state.position.y == Approx(y).margin(1e-3));
  CHECK(state.position.z == 0);
  CHECK(state.linear_velocity.x() == Approx(3 * rn).margin(1e-4));
  CHECK(state.linear_velocity.y() == Approx(vy).margin(1e-4));
}

TEST_CASE("a ball bounces to the square of its restitution") {
  std::vector<BodyDefinition> table(1);
  table[0].restitution = 0.8f;
  table[0].linear_damping = 0;
  std::vector<StaticDefinition> floor(1);
  floor[0].restitution = 1.0f;
  PhysicsWorld world(PhysicsSettings{}, table, floor, 64);
  const NewBody ball_at_3m = body(0, 0, 0, 3.5, 0);
  world.add({&ball_at_3m, 1});
  bool hit = false;
  double top = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(tick_s);
    const BodyState s = world.state(ball_at_3m.id);
    hit |= s.linear_velocity.y() > 1;
    if (hit) top = std::max(top, s.position.y - 0.5);
  }
  // It falls 3 m. The contact is met up to one step (0.12 m at 7.7 m/s) early or late.
  CHECK(top == Approx(3 * 0.8 * 0.8).margin(0.2));
}

TEST_CASE("a resting body falls asleep after 0.4 s and stays so, to the bit") {
  PhysicsWorld world = world_on_ground();
  const NewBody box = body(0, cube, 0, 0.5, 0);
  world.add({&box, 1});
  run(world, 20);
  CHECK(!world.is_asleep(box.id));
  run(world, 15);
  REQUIRE(world.is_asleep(box.id));
  CHECK(world.awake_count() == 0);
  const BodyState asleep = world.state(box.id);
  run(world, 500);
  CHECK(identical(world.state(box.id), asleep));
}

TEST_CASE("a box that slides at 0.7 m/s is not frozen") {
  std::vector<BodyDefinition> table(1);
  table[0].shape = BoxShape{{0.5f, 0.5f, 0.5f}};
  table[0].friction = 0;
  table[0].linear_damping = 0;
  PhysicsWorld world(PhysicsSettings{}, table, ground(), 64);
  NewBody box = body(0, 0, 0, 0.5, 0);
  box.state.linear_velocity = {0.7f, 0, 0};
  world.add({&box, 1});
  run(world, 125);
  CHECK(!world.is_asleep(box.id));
  CHECK(world.position(box.id).x == Approx(1.4).margin(0.01));
}

TEST_CASE("an upright body does not fall over when it is pushed") {
  PhysicsWorld world = world_on_ground();
  NewBody person = body(0, avatar, 0, 0.9, 0);
  person.state.angular_velocity = {1, 2, 3};
  world.add({&person, 1});
  for (int i = 0; i < 60; ++i) {
    world.apply_force(person.id, {8, 0, 0});
    world.step(tick_s);
  }
  CHECK(world.state(person.id).orientation.coeffs() == Eigen::Quaternionf::Identity().coeffs());
  CHECK(world.state(person.id).angular_velocity == Eigen::Vector3f(0, 0, 0));
  CHECK(world.position(person.id).x > 0.5);
}

TEST_CASE("a force lasts one step and an impulse changes velocity at once") {
  std::vector<BodyDefinition> table(1);
  table[0].mass_kg = 2;
  table[0].linear_damping = 0;
  PhysicsSettings weightless;
  weightless.gravity = {0, 0, 0};
  PhysicsWorld world(weightless, table, {}, 64);
  const NewBody thing = body(0, 0, 0, 0, 0);
  world.add({&thing, 1});
  world.apply_impulse(thing.id, {4, 0, 0});
  CHECK(world.state(thing.id).linear_velocity.x() == 2.0f);
  world.apply_force(thing.id, {0, 100, 0});
  run(world, 3);
  CHECK(world.state(thing.id).linear_velocity.y() == Approx(100 * 0.016 / 2));
}

TEST_CASE("every shape comes to rest where its surface touches the ground") {
  PhysicsWorld world = world_on_ground();
  const double height[] = {0.5, 0.5, 0.6, 0.4, 0.4, 0.45, 0.25};
  for (std::uint16_t kind = 0; kind < avatar; ++kind) {
    const NewBody b = body(kind, kind, 5.0 * kind, height[kind] + 0.05, 0);
    world.add({&b, 1});
  }
  run(world, 25);
  // Bullet lets resting bodies sink by about its penetration slop.
  for (std::uint16_t kind = 0; kind < avatar; ++kind) {
    INFO("shape " << kind);
    CHECK(world.position(BodyId::world(kind)).y == Approx(height[kind]).margin(0.01));
  }
}

TEST_CASE("an obstacle pushes a body and is not pushed back") {
  PhysicsWorld world = world_on_ground();
  NewBody rammed = body(0, cube, 0, 0.5, 0);
  world.add({&rammed, 1});
  NewBody ram = body(1, cube, -2, 0.5, 0);
  ram.state.linear_velocity = {4, 0, 0};
  world.add_obstacle(ram);
  run(world, 50);
  const BodyState state = world.state(ram.id);
  // 50 additions of 0.064 in floats.
  CHECK(state.position.x == Approx(-2 + 4 * 0.8).margin(1e-5));
  CHECK(state.position.y == 0.5);
  CHECK(state.linear_velocity == Eigen::Vector3f(4, 0, 0));
  CHECK(world.position(rammed.id).x > 2);
}

TEST_CASE("an obstacle at rest does not keep its neighbours awake") {
  PhysicsWorld world = world_on_ground();
  const NewBody lower = body(0, cube, 0, 0.5, 0);
  const NewBody upper = body(1, cube, 0, 1.5, 0);
  world.add_obstacle(lower);
  world.add({&upper, 1});
  run(world, 60);
  CHECK(world.is_asleep(upper.id));
  CHECK(world.position(upper.id).y == Approx(1.5).margin(0.01));
}
