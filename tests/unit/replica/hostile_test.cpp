// Numbers that no region should send: each ends in an Error, none in the store.
#include <cmath>
#include <functional>
#include <limits>

#include "server/replica/replica_store.h"
#include "server/replica/replica_wire.h"
#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {
constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr double nan_d = std::numeric_limits<double>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

/// What the store says to this update after a valid one, which must not suffer.
bool is_refused(const Update& update) {
  ReplicaStore store(2);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(10).key({.id = box, .slot = 1, .position = {3, 0, 0}}).bytes()));
  const Status status = store.apply(r0, update.bytes());
  REQUIRE(store.sample_body(box, at_tick(10))->position.x == 3);
  if (!status) {
    REQUIRE_FALSE(status.error().message.empty());
    REQUIRE(store.size() == 1);
  }
  return !status;
}
bool is_refused(const Key& key) {
  return is_refused(Update(11).key(key));
}
Key spoilt(const std::function<void(Key&)>& spoil) {
  Key key;
  spoil(key);
  return key;
}
}  // namespace

TEST_CASE("The key that the other cases spoil is valid") {
  CHECK_FALSE(is_refused(Key{}));
}

TEST_CASE("A body with a name that no body can have is refused") {
  CHECK(is_refused(spoilt([](Key& k) { k.id = BodyId{0}; })));
  CHECK(is_refused(spoilt([](Key& k) { k.id = BodyId{std::uint64_t{5} << 56}; })));
  CHECK(is_refused(spoilt([](Key& k) { k.id = BodyId{~std::uint64_t{0}}; })));
}

TEST_CASE("A version of another region is refused, in keys and in removals") {
  CHECK(is_refused(spoilt([](Key& k) { k.version = version_of(r1, 1); })));
  CHECK(is_refused(Update(11).removed(ball, version_of(r1, 9))));
  CHECK(is_refused(Update(11).removed(box, version_of(r1, 9))));
  CHECK(is_refused(Update(11).removed(BodyId{0}, version_of(r0, 9))));
}

TEST_CASE("Slots are less than a million, prototypes less than the world has, activations 0 to 2") {
  CHECK_FALSE(is_refused(spoilt([](Key& k) { k.slot = 999'999; })));
  CHECK(is_refused(spoilt([](Key& k) { k.slot = 1'000'000; })));
  CHECK(is_refused(spoilt([](Key& k) { k.slot = ~0u; })));
  CHECK_FALSE(is_refused(spoilt([](Key& k) { k.prototype = 1; })));
  CHECK(is_refused(spoilt([](Key& k) { k.prototype = 2; })));
  CHECK_FALSE(is_refused(spoilt([](Key& k) { k.activation = 2; })));
  CHECK(is_refused(spoilt([](Key& k) { k.activation = 3; })));
}

TEST_CASE("Positions are numbers inside the world") {
  for (double bad : {nan_d, double(inf_f), -double(inf_f), 8192.001, -8192.001, 1e300}) {
    CHECK(is_refused(spoilt([&](Key& k) { k.position.x = bad; })));
    CHECK(is_refused(spoilt([&](Key& k) { k.position.y = bad; })));
    CHECK(is_refused(spoilt([&](Key& k) { k.position.z = bad; })));
  }
  CHECK_FALSE(is_refused(spoilt([&](Key& k) { k.position = {8192, -8192, 0}; })));
}

TEST_CASE("Orientations are nearly of length one") {
  for (Eigen::Quaternionf bad :
       {Eigen::Quaternionf(0, 0, 0, 0), Eigen::Quaternionf(1.01f, 0, 0, 0),
        Eigen::Quaternionf(nan_f, 0, 0, 0), Eigen::Quaternionf(1, inf_f, 0, 0),
        Eigen::Quaternionf(3e38f, 3e38f, 0, 0)})
    CHECK(is_refused(spoilt([&](Key& k) { k.orientation = bad; })));
  CHECK_FALSE(
      is_refused(spoilt([](Key& k) { k.orientation = Eigen::Quaternionf(0, 0, 1.0005f, 0); })));
}

TEST_CASE("Velocities and sleeping times are finite") {
  for (float bad : {nan_f, inf_f, -inf_f}) {
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(is_refused(spoilt([&](Key& k) { k.linear_velocity[axis] = bad; })));
      CHECK(is_refused(spoilt([&](Key& k) { k.angular_velocity[axis] = bad; })));
    }
    CHECK(is_refused(spoilt([&](Key& k) { k.deactivation_time_s = bad; })));
  }
}

TEST_CASE("A motion of a slot that was never bound is refused") {
  CHECK_FALSE(is_refused(Update(11).motion(1, {3, 0, 0})));
  CHECK(is_refused(Update(11).motion(0, {})));
  CHECK(is_refused(Update(11).motion(2, {})));
  CHECK(is_refused(Update(11).motion(~0u, {})));
}

TEST_CASE("Ticks do not go back, and are not so large that times overflow") {
  CHECK_FALSE(is_refused(Update(10)));
  CHECK(is_refused(Update(9)));
  CHECK_FALSE(is_refused(Update(replica_tick_max)));
  CHECK(is_refused(Update(replica_tick_max + 1)));
  CHECK(is_refused(Update(std::numeric_limits<std::int64_t>::max())));
  CHECK(is_refused(Update(std::numeric_limits<std::int64_t>::min())));
}

TEST_CASE("Player 0 is nobody, and only bodies can be carried") {
  CHECK_FALSE(is_refused(Update(11).player(1, 1, 1)));
  CHECK(is_refused(Update(11).player(0, 1, 1)));
  CHECK(is_refused(Update(11).player(1, 1, 1, BodyId{5})));
}

TEST_CASE("Bytes that are not a ReplicaUpdate are refused") {
  ReplicaStore store(1);
  store.region_up(r0);
  CHECK_FALSE(store.apply(r0, {}));
  CHECK_FALSE(store.apply(r0, Bytes(7)));
  CHECK_FALSE(store.apply(r0, Bytes(64, std::byte{0xff})));
  Bytes good = Update(1).key({}).bytes();
  good.resize(good.size() - 16);
  CHECK_FALSE(store.apply(r0, good));
}
