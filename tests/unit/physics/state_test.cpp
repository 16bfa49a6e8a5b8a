// State goes in and comes out unchanged, and nonsense is recognised.
#include <limits>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

TEST_CASE("a thousand random states come back exactly as they were put in") {
  std::mt19937 random(3);
  const auto number = [&](float scale) {
    return scale * (static_cast<float>(random() >> 8) * 0x1p-23f - 1);
  };
  PhysicsWorld world(PhysicsSettings{}, prototypes(), {}, 1024);
  std::vector<NewBody> bodies;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    NewBody b = body(i, static_cast<std::uint16_t>(i % avatar), double{number(500)},
                     double{number(500)}, double{number(500)});
    b.state.orientation = Eigen::Quaternionf(number(1), number(1), number(1), 1.1f).normalized();
    b.state.linear_velocity = {number(20), number(20), number(20)};
    b.state.angular_velocity = {number(20), number(20), number(20)};
    b.state.activation = static_cast<Activation>(i % 3);
    b.state.deactivation_time_s = std::abs(number(0.4f));
    bodies.push_back(b);
  }
  world.add(bodies);
  for (const NewBody& b : bodies) REQUIRE(identical(world.state(b.id), b.state));

  PhysicsWorld other(PhysicsSettings{}, prototypes(), {}, 1024);
  other.add(bodies_of(world));
  CHECK(other.state_hash() == world.state_hash());
}

TEST_CASE("a lone moving body that changes its world goes on bit for bit") {
  PhysicsWorld stays(PhysicsSettings{}, prototypes(), {}, 64);
  NewBody b = body(0, hull, 3, 100, -7);
  b.state.linear_velocity = {5, 2, -1};
  b.state.angular_velocity = {3, -4, 2};
  stays.add({&b, 1});
  run(stays, 20);
  PhysicsWorld receiver(PhysicsSettings{}, prototypes(), {}, 64);
  receiver.add(bodies_of(stays));
  for (int i = 0; i < 100; ++i) {
    stays.step(tick_s);
    receiver.step(tick_s);
    REQUIRE(stays.state_hash() == receiver.state_hash());
  }
}

TEST_CASE("a body added asleep stays asleep and keeps its bits") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> tower = plain_tower();
  for (NewBody& b : tower) {
    b.state.activation = Activation::asleep;
    b.state.deactivation_time_s = 0.41f;
  }
  world.add(tower);
  CHECK(world.awake_count() == 0);
  run(world, 200);
  for (const NewBody& b : tower) CHECK(identical(world.state(b.id), b.state));
}

TEST_CASE("positions far from a world's origin are kept as doubles") {
  PhysicsSettings settings;
  settings.origin = {1e6, 0, -2e6};
  PhysicsWorld world(settings, prototypes(), {}, 64);
  const NewBody b = body(0, ball, 1e6 + 0.25, 3.5, -2e6 - 7.125);
  world.add({&b, 1});
  CHECK(world.position(b.id) == b.state.position);
}

TEST_CASE("set_state puts a body elsewhere and wakes what stood on it") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> two{body(0, cube, 0, 0.5, 0), body(1, cube, 0, 1.5, 0)};
  world.add(two);
  run(world, 100);
  REQUIRE(world.awake_count() == 0);
  BodyState moved = world.state(two[0].id);
  moved.position.x = 10;
  world.set_state(two[0].id, moved);
  CHECK(identical(world.state(two[0].id), moved));
  CHECK(!world.is_asleep(two[1].id));
  run(world, 100);
  CHECK(world.position(two[1].id).y == Approx(0.5).margin(0.01));
}

TEST_CASE("set_velocity, impulses and forces wake a sleeping body") {
  PhysicsWorld world = world_on_ground();
  std::vector<NewBody> three{body(0, cube, 0, 0.5, 0), body(1, cube, 4, 0.5, 0),
                             body(2, cube, 8, 0.5, 0)};
  for (NewBody& b : three) b.state.activation = Activation::asleep;
  world.add(three);
  world.set_velocity(three[0].id, {0, 3, 0}, {0, 1, 0});
  CHECK(world.awake_count() == 1);
  world.apply_impulse(three[1].id, {0, 3, 0});
  CHECK(world.awake_count() == 2);
  world.apply_force(three[2].id, {0, 300, 0});
  CHECK(world.awake_count() == 3);
  world.step(tick_s);
  for (const NewBody& b : three) CHECK(world.position(b.id).y > 0.5);
}

TEST_CASE("a state with NaN, infinity or a stretched orientation is not sane") {
  const BodyState good;
  CHECK(is_sane(good));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const auto refused = [&](auto spoil) {
    BodyState s = good;
    spoil(s);
    return !is_sane(s);
  };
  for (const float bad : {nan, inf, -inf}) {
    CHECK(refused([&](BodyState& s) { s.position.x = double{bad}; }));
    CHECK(refused([&](BodyState& s) { s.position.y = double{bad}; }));
    CHECK(refused([&](BodyState& s) { s.position.z = double{bad}; }));
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(refused([&](BodyState& s) { s.linear_velocity[axis] = bad; }));
      CHECK(refused([&](BodyState& s) { s.angular_velocity[axis] = bad; }));
    }
    for (int k = 0; k < 4; ++k)
      CHECK(refused([&](BodyState& s) { s.orientation.coeffs()[k] = bad; }));
    CHECK(refused([&](BodyState& s) { s.deactivation_time_s = bad; }));
  }
  // How large they may be is another question.
  CHECK(!refused([&](BodyState& s) { s.position.x = 1e308; }));
  CHECK(!refused([&](BodyState& s) { s.linear_velocity.y() = -1e38f; }));
  CHECK(refused([&](BodyState& s) { s.orientation.coeffs() *= 1.01f; }));
  CHECK(refused([&](BodyState& s) { s.orientation.coeffs().setZero(); }));
  CHECK(refused([&](BodyState& s) { s.deactivation_time_s = -1; }));
  CHECK(refused([&](BodyState& s) { s.activation = static_cast<Activation>(9); }));
  CHECK(!refused([&](BodyState& s) { s.orientation.coeffs() *= 1.0005f; }));
}

TEST_CASE("a contact with too many points, NaN or a bent normal is not sane") {
  ContactManifold good{BodyId::world(0), StaticId{0}, 0, {ContactPoint{}}};
  CHECK(is_sane(good));
  ContactManifold bad = good;
  bad.points.resize(5);
  CHECK(!is_sane(bad));
  bad.points.clear();
  CHECK(!is_sane(bad));
  bad = good;
  bad.points[0].normal_on_b = {0, 0.5f, 0};
  CHECK(!is_sane(bad));
  bad = good;
  bad.points[0].impulse = std::numeric_limits<float>::quiet_NaN();
  CHECK(!is_sane(bad));
}

TEST_CASE("a capsule 2 m high with a radius of 0.3 m lies within a sphere of 1 m") {
  CHECK(bounding_radius(CapsuleShape{0.3f, 2.0f}) == Approx(1.0f));
  CHECK(bounding_radius(SphereShape{0.7f}) == Approx(0.7f));
  CHECK(bounding_radius(BoxShape{{1, 2, 2}}) == Approx(3.0f));
  CHECK(bounding_radius(CylinderShape{3, 8}) == Approx(5.0f));
  CHECK(bounding_radius(ConvexHullShape{{{1, 0, 0}, {0, 2, 0}, {0, 0, 0.5f}, {-1, 0, 0}}}) ==
        Approx(2.0f));
  CHECK(std::isinf(bounding_radius(PlaneShape{})));
  const auto upright = std::make_shared<const Shape>(CylinderShape{1, 2});
  const Eigen::Quaternionf lying(
      Eigen::AngleAxisf(static_cast<float>(M_PI / 2), Eigen::Vector3f::UnitZ()));
  // Its axis along x: the far rim is 3 m along and 1 m across.
  CHECK(bounding_radius(CompoundShape{{{upright, {2, 0, 0}, lying}}}) == Approx(std::sqrt(10.0f)));
}
