// Where a body is between its states: exact at ticks, still until it wakes, smooth across owners.
#include <cmath>

#include "server/replica/replica_store.h"
#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {
double x_of(const ReplicaStore& store, double tick) {
  return store.sample_body(ball, at_tick(tick))->position.x;
}
Eigen::Quaternionf turned(float rad) {
  return Eigen::Quaternionf(Eigen::AngleAxisf(rad, Eigen::Vector3f::UnitY()));
}
struct Fixture {
  ReplicaStore store{1};
  Fixture() {
    for (RegionId r : {r0, r1}) store.region_up(r);
  }
  void hear(RegionId from, const Update& update) { REQUIRE(store.apply(from, update.bytes())); }
};
}  // namespace

TEST_CASE("At a tick the pose is exactly that tick's, between two ticks it is exactly in between") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 2, 3}}));
  f.hear(r0, Update(2).motion(0, {2, 4, -3}));
  f.hear(r0, Update(3).motion(0, {4, 4, 4}));
  CHECK(f.store.sample_body(ball, at_tick(1))->position == WorldPosition{1, 2, 3});
  CHECK(f.store.sample_body(ball, at_tick(2))->position == WorldPosition{2, 4, -3});
  CHECK(f.store.sample_body(ball, at_tick(3))->position == WorldPosition{4, 4, 4});
  CHECK(f.store.sample_body(ball, at_tick(1.5))->position == WorldPosition{1.5, 3, 0});
  CHECK(f.store.sample_body(ball, at_tick(1.25))->position == WorldPosition{1.25, 2.5, 1.5});
  CHECK(f.store.sample_body(ball, at_tick(2.5))->position == WorldPosition{3, 4, 0.5});
}

TEST_CASE("Nothing is extrapolated: before the oldest pose and after the newest the body rests") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}}));
  f.hear(r0, Update(2).motion(0, {2, 0, 0}));
  CHECK(x_of(f.store, -5) == 1);
  CHECK(x_of(f.store, 0.9) == 1);
  CHECK(x_of(f.store, 2.1) == 2);
  CHECK(x_of(f.store, 1e9) == 2);
}

TEST_CASE("The last eight poses are remembered") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}}));
  for (int tick = 2; tick <= 20; ++tick) f.hear(r0, Update(tick).motion(0, {double(tick), 0, 0}));
  for (double tick = 13; tick <= 20; tick += 0.5) CHECK(x_of(f.store, tick) == tick);
  CHECK(x_of(f.store, 12) == 13);
}

TEST_CASE("Orientations are unit quaternions on the short way round") {
  Fixture f;
  // The two have opposite signs as they come off the wire, where the largest component is positive.
  const float before = 1.55f;
  const float after = 1.65f;
  f.hear(r0, Update(1).key({.orientation = turned(before)}));
  f.hear(r0, Update(2).motion(0, {}, Eigen::Quaternionf(-turned(after).coeffs())));
  for (float share : {0.0f, 0.1f, 0.5f, 0.9f, 1.0f}) {
    const auto pose = f.store.sample_body(ball, at_tick(1 + double(share)));
    CHECK(std::abs(pose->orientation.norm() - 1) < 1e-6f);
    const Eigen::Quaternionf expected = turned(before + share * (after - before));
    // Both ends are quantised; the straight way differs from the arc by less than that here.
    CHECK(pose->orientation.angularDistance(expected) < 2 * orientation_error_rad);
  }
  const Eigen::Quaternionf over_the_top = turned(4.0f);
  f.hear(r0, Update(3).motion(0, {}, turned(3.9f)));
  f.hear(r0, Update(4).motion(0, {}, turned(4.1f)));
  CHECK(f.store.sample_body(ball, at_tick(3.5))->orientation.angularDistance(over_the_top) <
        2 * orientation_error_rad);
}

TEST_CASE(
    "A body that slept and wakes stays at its old pose until one tick before its next state") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}, .activation = 2}));
  for (int tick = 2; tick < 100; ++tick) f.hear(r0, Update(tick));
  f.hear(r0, Update(100).key({.position = {2, 0, 0}}));
  CHECK(x_of(f.store, 1) == 1);
  CHECK(x_of(f.store, 50) == 1);
  CHECK(x_of(f.store, 99) == 1);
  CHECK(x_of(f.store, 99.5) == 1.5);
  CHECK(x_of(f.store, 100) == 2);
}

TEST_CASE("A body that lay still awake for one tick only stays there for that tick") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}}));
  f.hear(r0, Update(2));
  f.hear(r0, Update(3).motion(0, {2, 0, 0}));
  CHECK(x_of(f.store, 1.5) == 1);
  CHECK(x_of(f.store, 2) == 1);
  CHECK(x_of(f.store, 2.5) == 1.5);
}

TEST_CASE("A body that falls asleep is drawn as awake until the moment it does") {
  Fixture f;
  f.hear(r0, Update(1).key({}));
  f.hear(r0, Update(2).key({.activation = 2}));
  CHECK_FALSE(f.store.sample_body(ball, at_tick(1.5))->asleep);
  CHECK(f.store.sample_body(ball, at_tick(2))->asleep);
}

TEST_CASE("While its server skips ticks a moving body is drawn as moving evenly") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {0, 0, 0}}));
  f.hear(r0, Update(4).motion(0, {3, 0, 0}));
  CHECK(x_of(f.store, 2) == 1);
  CHECK(x_of(f.store, 3) == 2);
}

TEST_CASE("A server that was silent for long makes its bodies wait, not creep") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {0, 0, 0}}));
  f.hear(r0, Update(101).motion(0, {100, 0, 0}));
  CHECK(x_of(f.store, 50) == 0);
  CHECK(x_of(f.store, 100.5) == 50);
}

TEST_CASE("A moving body that changes its owner goes on smoothly across the gap") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}}));
  f.hear(r0, Update(2).motion(0, {2, 0, 0}));
  f.hear(r1, Update(2));
  f.hear(r1, Update(5).key({.version = version_of(r1, 2), .position = {5, 0, 0}}));
  f.hear(r1, Update(6).motion(0, {6, 0, 0}));
  for (double tick = 1; tick <= 6; tick += 0.25) CHECK(x_of(f.store, tick) == tick);
}

TEST_CASE("A body that was handed over asleep and woken there does not creep either") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}, .activation = 2}));
  f.hear(r1, Update(10).key({.version = version_of(r1, 2), .position = {3, 0, 0}}));
  CHECK(x_of(f.store, 9) == 1);
  CHECK(x_of(f.store, 9.5) == 2);
}

TEST_CASE("A motion in the tick of a key replaces it") {
  Fixture f;
  f.hear(r0, Update(1).key({.position = {1, 0, 0}}).motion(0, {2, 0, 0}));
  CHECK(x_of(f.store, 0) == 2);
  CHECK(x_of(f.store, 1) == 2);
}
