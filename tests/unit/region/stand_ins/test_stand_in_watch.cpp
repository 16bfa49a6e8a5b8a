// The watch over stand-ins in a real world: what is struck, what is pressed, and what is neither.
#include "server/region/stand_ins/stand_in_watch.h"

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Two boxes and a ball of ours, and what stand-ins are: a box, too, of 1 kg unless said otherwise.
constexpr PrototypeId ball{0}, box{1}, heavy_box{2}, theirs{3};
const BodyId stand_in = BodyId::world(0);
const BodyId ours = BodyId::world(1);
const BodyId second = BodyId::world(2);

std::vector<BodyDefinition> definitions() {
  std::vector<BodyDefinition> table(4);
  table[ball.value].shape = SphereShape{0.5f};
  for (const PrototypeId one : {box, heavy_box, theirs})
    table[one.value].shape = BoxShape{{0.5f, 0.5f, 0.5f}};
  table[heavy_box.value].mass_kg = 10;
  for (BodyDefinition& one : table) one.restitution = 0;
  return table;
}

PhysicsSettings weightless() {
  PhysicsSettings settings;
  settings.gravity.setZero();
  return settings;
}

/// A box of another server's at the origin, and the watch over it.
struct Watched {
  std::vector<BodyDefinition> table = definitions();
  PhysicsWorld physics;
  StandInWatch watch;
  Tick now{100};
  std::set<BodyId> still;
  std::vector<StandInWatch::Struck> all_struck;  ///< Of every look, in order.

  explicit Watched(const PhysicsSettings& settings = {}) : physics(settings, table, {}, 16) {
    const NewBody other{stand_in, theirs, {}};
    physics.add_stand_ins({&other, 1});
  }
  void add(PrototypeId prototype, WorldPosition at, Eigen::Vector3f velocity = {0, 0, 0}) {
    NewBody body{ours, prototype, {}};
    body.state.position = at;
    body.state.linear_velocity = velocity;
    physics.add({&body, 1});
  }
  /// Another box of another server's.
  void put_second(WorldPosition at) { put(second, at); }
  void put(BodyId id, WorldPosition at) {
    NewBody other{id, theirs, {}};
    other.state.position = at;
    physics.add_stand_ins({&other, 1});
  }
  void lose_second() { physics.remove_stand_ins(std::span(&second, 1), Wake::touching); }
  /// Puts the body where it was not before, as fast as said.
  void throw_from(WorldPosition at, Eigen::Vector3f velocity) {
    BodyState state = physics.state(ours);
    state.position = at;
    state.linear_velocity = velocity;
    state.activation = Activation::awake;
    physics.set_state(ours, state);
  }
  /// Pushes it down, or not, in each step.
  void step(int ticks = 1, float push_n = 0) {
    for (int i = 0; i < ticks; ++i) {
      physics.apply_force(ours, {0, -push_n, 0});  // Keeps it awake too.
      physics.step(tick_s);
      now = now + 1;
      watch.look(
          physics, now, [&](BodyId id) { return still.contains(id); },
          [&](PrototypeId one) { return double{table[one.value].mass_kg}; });
      all_struck.insert(all_struck.end(), watch.struck_now().begin(), watch.struck_now().end());
    }
  }
};

/// A push that makes a stand-in of 1 kg take so much more in each step (N).
constexpr float push_for(double rise_mps) {
  return static_cast<float>(rise_mps) / tick_s;
}

/// A box that lies still on the stand-in; its load has found its level after `ticks`.
Watched cut_at_rest(PrototypeId prototype = box) {
  Watched scene;
  scene.add(prototype, {0, 1, 0});
  scene.still.insert(ours);
  return scene;
}

/// A box of 10 kg that has lain still on two stand-ins; the first one alone carries it, too.
Watched on_two_stand_ins() {
  Watched scene;
  scene.put_second({1, 0, 0});
  scene.add(heavy_box, {0.4, 1, 0});
  scene.still.insert(ours);
  scene.step(40);
  REQUIRE(scene.watch.struck() == 0);
  REQUIRE_FALSE(scene.watch.is_pressed(ours, scene.now));
  return scene;
}

}  // namespace

TEST_CASE("a ball that flies into a stand-in strikes it once, and it is told who and when") {
  Watched scene(weightless());
  scene.add(ball, {-3, 0, 0}, {5, 0, 0});
  Tick met;
  for (int i = 0; i < 60; ++i) {
    const float before = scene.physics.state(ours).linear_velocity.x();
    scene.step();
    const float after = scene.physics.state(ours).linear_velocity.x();
    if (met == Tick{} && after < before - 0.5f) met = scene.now;
    CHECK(scene.watch.struck_now().size() == (scene.now == met ? 1 : 0));
  }
  REQUIRE(scene.all_struck.size() == 1);
  CHECK(scene.watch.struck() == 1);
  CHECK(scene.all_struck[0].stand_in == stand_in);
  CHECK(scene.all_struck[0].body == ours);
  CHECK(scene.all_struck[0].tick == met);
  // All of its 5 N s, or most: what is left of the way to the surface is gone first.
  CHECK(scene.all_struck[0].rise_mps > 2);
  CHECK(scene.all_struck[0].rise_mps < 5.5);
}

TEST_CASE("what flies past a stand-in, or lies beside it, strikes nothing") {
  Watched scene(weightless());
  scene.add(ball, {-3, 1.1, 0}, {5, 0, 0});
  scene.step(80);
  REQUIRE(scene.physics.position(ours).x > 2);
  CHECK(scene.watch.struck() == 0);
  CHECK_FALSE(scene.watch.is_pressed(ours, scene.now));
}

TEST_CASE("a load that rises a little makes the body pressed for a while, but nothing is struck") {
  Watched scene = cut_at_rest();
  scene.step(40);
  REQUIRE_FALSE(scene.watch.is_pressed(ours, scene.now));
  scene.step(1, push_for(0.08));
  CHECK(scene.watch.is_pressed(ours, scene.now));
  CHECK(scene.watch.struck() == 0);
  scene.step(20, push_for(0.08));
  CHECK(scene.watch.struck() == 0);
  const Tick last_push = scene.now;
  scene.step(static_cast<int>(StandInWatch::pressed_ticks));
  CHECK(scene.watch.is_pressed(ours, scene.now));
  // The step after a push may still carry some of it.
  scene.step(4);
  CHECK_FALSE(scene.watch.is_pressed(ours, scene.now));
  CHECK(scene.now - last_push == StandInWatch::pressed_ticks + 4);
}

TEST_CASE("a load that rises by more than what leaves a resting body at rest is a missed blow") {
  Watched scene = cut_at_rest();
  scene.step(40);
  scene.step(1, push_for(0.3));
  CHECK(scene.watch.struck() == 1);
  CHECK(scene.watch.is_pressed(ours, scene.now));
}

TEST_CASE("the same push counts by what it would do to the stand-in's mass") {
  Watched scene = cut_at_rest();
  scene.table[theirs.value].mass_kg = 20;
  scene.step(40);
  scene.step(10, push_for(0.3));
  CHECK(scene.watch.struck() == 0);
  CHECK_FALSE(scene.watch.is_pressed(ours, scene.now));
}

TEST_CASE("the first loads of a pair that was cut at rest are its base, whatever they weigh") {
  Watched resting = cut_at_rest(heavy_box);
  resting.step(60);
  CHECK(resting.watch.struck() == 0);
  CHECK_FALSE(resting.watch.is_pressed(ours, resting.now));

  // Ten times the stand-in's weight would be a blow of 1.6 m/s by anybody who moves.
  Watched moving = cut_at_rest(heavy_box);
  moving.still.clear();
  moving.step(60);
  CHECK(moving.watch.struck() == 1);
}

TEST_CASE("while the load of a cut pair finds its level its base goes up with it, and not after") {
  constexpr double more_mps = 0.5;
  Watched early = cut_at_rest(), late = cut_at_rest();
  early.step(5);
  early.step(5, push_for(more_mps));
  CHECK_FALSE(early.watch.is_pressed(ours, early.now));
  early.step(40);
  early.step(5, push_for(more_mps));
  CHECK(early.watch.struck() == 0);

  late.step(static_cast<int>(StandInWatch::settling_ticks) + 1);
  late.step(5, push_for(more_mps));
  CHECK(late.watch.struck() == 1);
}

TEST_CASE("a blow is a blow even while the load of a cut pair finds its level") {
  Watched scene = cut_at_rest();
  scene.step(5);
  scene.step(1, push_for(2 * StandInWatch::blow_mps));
  CHECK(scene.watch.struck() == 1);
  REQUIRE(scene.all_struck.size() == 1);
  CHECK(scene.all_struck[0].tick == scene.now);
}

TEST_CASE("what leans on two stand-ins and loses one leans on the other, and strikes nothing") {
  Watched scene = on_two_stand_ins();
  scene.lose_second();
  scene.step(4);
  CHECK(scene.watch.is_pressed(ours, scene.now));
  CHECK(scene.watch.struck() == 0);
  // What it bears from now on is no blow either, but what comes on top of it is.
  scene.step(60);
  CHECK(scene.watch.struck() == 0);
  scene.step(1, push_for(0.3));
  CHECK(scene.watch.struck() == 1);
}

TEST_CASE("a load that shifts strikes if the body moves, or long after it lost a stand-in") {
  Watched moving = on_two_stand_ins();
  moving.still.clear();
  moving.lose_second();
  moving.step(4);
  CHECK(moving.watch.struck() == 1);

  Watched late = on_two_stand_ins();
  late.lose_second();
  late.step(static_cast<int>(StandInWatch::settling_ticks) + 1);
  late.step(2, push_for(0.3));
  CHECK(late.watch.struck() == 1);
}

TEST_CASE("a stand-in that is lost while another one comes elsewhere is lost all the same") {
  Watched scene = on_two_stand_ins();
  scene.lose_second();
  scene.put(BodyId::world(3), {50, 0, 0});
  scene.step(4);
  CHECK(scene.watch.is_pressed(ours, scene.now));
  CHECK(scene.watch.struck() == 0);
}

TEST_CASE("what leans on a stand-in and gets another one may find its level anew") {
  const auto struck_after = [](std::int64_t ticks) {
    Watched scene;
    scene.add(heavy_box, {0.4, 1, 0});
    scene.still.insert(ours);
    scene.step(40);
    scene.put_second({1, 0, 0});
    scene.step(static_cast<int>(ticks));
    scene.step(1, push_for(1.2));  // On two stand-ins.
    CHECK(scene.watch.is_pressed(ours, scene.now));
    return scene.watch.struck();
  };
  CHECK(struck_after(3) == 0);
  CHECK(struck_after(StandInWatch::settling_ticks + 1) > 0);
}

TEST_CASE("a blow is a blow even where another stand-in has just been lost") {
  Watched scene = on_two_stand_ins();
  scene.lose_second();
  scene.step(1, push_for(2 * StandInWatch::blow_mps));
  CHECK(scene.watch.struck() == 1);
}

TEST_CASE("a stand-in that is lost excuses only those who leant on it") {
  Watched scene = cut_at_rest();
  scene.put_second({1.2, 0, 0});  // Beside the first one, and nobody's support.
  scene.step(40);
  scene.lose_second();
  scene.step(1, push_for(0.3));
  CHECK(scene.watch.struck() == 1);
}

TEST_CASE("a pair that was apart for a moment is the same pair; one that was gone begins anew") {
  const auto struck_after_gap = [](double gap_m) {
    Watched scene(weightless());
    scene.add(ball, {-1.5, 0, 0}, {5, 0, 0});
    scene.step(20);
    REQUIRE(scene.watch.struck() == 1);
    scene.throw_from({-1 - gap_m, 0, 0}, {5, 0, 0});
    scene.step(60);
    return scene.watch.struck();
  };
  CHECK(struck_after_gap(0.25) == 1);  // It is back in the fourth step.
  CHECK(struck_after_gap(2.0) == 2);   // In the 25th.
}

TEST_CASE(
    "a contact that is lost for a step in which the body falls is no blow when it lies still") {
  // So high that Bullet finds no contact in one step, and in the next the body is back.
  const auto struck_by = [](bool still, float falls_mps) {
    Watched scene = cut_at_rest(heavy_box);
    scene.step(40);
    REQUIRE(scene.watch.struck() == 0);
    if (!still) scene.still.clear();
    const WorldPosition lay = scene.physics.position(ours);
    scene.throw_from({lay.x, lay.y + 0.05, lay.z}, {0, 0, 0});
    scene.step();
    scene.throw_from(lay, {0, -falls_mps, 0});
    scene.step();
    return scene.watch.struck();
  };
  constexpr auto fell_mps = static_cast<float>(9.81 * tick_s);
  CHECK(struck_by(true, fell_mps) == 0);
  CHECK(struck_by(false, fell_mps) == 1);
  CHECK(struck_by(true, 3 * fell_mps) == 1);
}

TEST_CASE("a pair that was gone has no base any more") {
  Watched scene = cut_at_rest(heavy_box);
  scene.step(40);
  REQUIRE(scene.watch.struck() == 0);
  scene.still.clear();
  scene.throw_from({0, 8, 0}, {0, 0, 0});
  scene.step(20);
  scene.throw_from({0, 1, 0}, {0, 0, 0});
  scene.step(10);
  CHECK(scene.watch.struck() == 1);
}
