// One region's stream: keys, slots, motions, sleep, completeness, links that come and go.
#include "server/replica/replica_store.h"
#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {
double x_of(const ReplicaStore& store, BodyId id, double tick) {
  return store.sample_body(id, at_tick(tick))->position.x;
}
}  // namespace

TEST_CASE("A key state brings a body in, exactly as it was sent") {
  ReplicaStore store(4);
  store.region_up(r0);
  Key key{.version = version_of(r0, 5, 9), .position = {1.23456789, -2, 3}, .prototype = 3};
  key.orientation = Eigen::Quaternionf(1, 2, 3, 4).normalized();
  key.linear_velocity = {1.5f, 0, -2.25f};
  key.angular_velocity = {0, 3.5f, 0};
  key.deactivation_time_s = 0.25f;
  key.activation = 1;
  REQUIRE(store.apply(r0, Update(10).key(key).bytes()));

  const auto held = store.key_state(ball);
  REQUIRE(held);
  CHECK(held->version == version_of(r0, 5, 9));
  CHECK(held->tick == Tick{10});
  CHECK(held->prototype == PrototypeId{3});
  CHECK(held->state.position == key.position);
  CHECK(held->state.orientation.coeffs() == key.orientation.coeffs());
  CHECK(held->state.linear_velocity == key.linear_velocity);
  CHECK(held->state.angular_velocity == key.angular_velocity);
  CHECK(held->state.deactivation_time_s == 0.25f);
  CHECK(held->state.activation == Activation::wants_sleep);
  CHECK(store.version(ball) == version_of(r0, 5, 9));
  CHECK(store.size() == 1);
}

TEST_CASE("A pose that came as a key is the same, bit for bit, as one that came as a motion") {
  const WorldPosition at{12.3456, 7.0001, -99.98765};
  const Eigen::Quaternionf turned = Eigen::Quaternionf(0.3f, -0.8f, 0.1f, 0.5f).normalized();
  ReplicaStore by_key(1);
  ReplicaStore by_motion(1);
  by_key.region_up(r0);
  by_motion.region_up(r0);
  REQUIRE(by_key.apply(r0, Update(1).key({.position = at, .orientation = turned}).bytes()));
  REQUIRE(by_motion.apply(r0, Update(0).key({}).bytes()));
  REQUIRE(by_motion.apply(r0, Update(1).motion(0, at, turned).bytes()));
  const auto a = *by_key.sample_body(ball, at_tick(1));
  const auto b = *by_motion.sample_body(ball, at_tick(1));
  CHECK(a.position == b.position);
  CHECK(a.orientation.coeffs() == b.orientation.coeffs());
  CHECK(a.position == dequantise(quantise(at)));
}

TEST_CASE("A motion moves the body of its slot, and leaves the exact state of the last key") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(
      store.apply(r0, Update(1).key({.id = ball, .slot = 4}).key({.id = box, .slot = 9}).bytes()));
  REQUIRE(store.apply(r0, Update(2).motion(9, {2, 0, 0}).bytes()));
  CHECK(x_of(store, box, 2) == 2);
  CHECK(x_of(store, ball, 2) == 0);
  CHECK(store.key_state(box)->tick == Tick{1});
  CHECK(store.key_state(box)->state.position.x == 0);
}

TEST_CASE("A slot that is bound again means the new body only") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({.id = ball, .slot = 4}).bytes()));
  REQUIRE(store.apply(r0, Update(2).key({.id = box, .slot = 4}).bytes()));
  REQUIRE(store.apply(r0, Update(3).motion(4, {2, 0, 0}).bytes()));
  CHECK(x_of(store, box, 3) == 2);
  CHECK(x_of(store, ball, 3) == 0);
}

TEST_CASE("A slot whose body is gone moves nobody, not even a body that took its place in memory") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({.id = ball, .slot = 4}).bytes()));
  REQUIRE(store.apply(r0, Update(2).removed(ball, version_of(r0, 1)).bytes()));
  REQUIRE(store.apply(r0, Update(3).key({.id = box, .slot = 5}).bytes()));
  REQUIRE(store.apply(r0, Update(4).motion(4, {2, 0, 0}).bytes()));
  CHECK(x_of(store, box, 4) == 0);
  CHECK_FALSE(store.sample_body(ball, at_tick(4)));
}

TEST_CASE("Bodies are sampled ascending by id, however they came and went") {
  ReplicaStore store(1);
  store.region_up(r0);
  std::uint32_t slot = 0;
  Update first(1);
  for (std::uint32_t n : {5u, 1u, 9u, 3u}) first.key({.id = BodyId::world(n), .slot = slot++});
  REQUIRE(store.apply(r0, first.bytes()));
  Update second(2);
  for (std::uint32_t n : {8u, 0u, 4u}) second.key({.id = BodyId::world(n), .slot = slot++});
  second.removed(BodyId::world(3), version_of(r0, 1));
  REQUIRE(store.apply(r0, second.bytes()));
  REQUIRE(store.apply(r0, Update(3).key({.id = BodyId::world(2), .slot = slot}).bytes()));
  std::vector<ReplicaPose> poses;
  store.sample(at_tick(3), poses);
  std::vector<BodyId> ids;
  for (const ReplicaPose& pose : poses) ids.push_back(pose.id);
  std::vector<BodyId> expected;
  for (std::uint32_t n : {0u, 1u, 2u, 4u, 5u, 8u, 9u}) expected.push_back(BodyId::world(n));
  CHECK(ids == expected);
}

TEST_CASE("Falling asleep and waking are counted, in all and for each owner") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r0, Update(1).key({.id = ball}).key({.id = box, .slot = 1}).bytes()));
  REQUIRE(store.apply(
      r1, Update(1).key({.id = BodyId::world(1), .version = version_of(r1, 1)}).bytes()));
  CHECK(store.awake_count() == 3);
  REQUIRE(store.apply(r0, Update(2).key({.id = box, .slot = 1, .activation = 2}).bytes()));
  CHECK(store.awake_count() == 2);
  CHECK(store.owner_counts(r0).bodies == 2);
  CHECK(store.owner_counts(r0).awake == 1);
  CHECK(store.owner_counts(r1).awake == 1);
  CHECK(store.owner_counts(r2).bodies == 0);
  REQUIRE(store.apply(r0, Update(3).key({.id = box, .slot = 1}).bytes()));
  CHECK(store.owner_counts(r0).awake == 2);
  REQUIRE(store.apply(r0, Update(4).removed(box, version_of(r0, 1)).bytes()));
  CHECK(store.owner_counts(r0).bodies == 1);
  CHECK(store.owner_counts(r0).awake == 1);
  CHECK(store.awake_count() == 2);
}

TEST_CASE("A motion of a sleeping body means that it is awake") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({.activation = 2}).bytes()));
  CHECK(store.sample_body(ball, at_tick(1))->asleep);
  CHECK(store.awake_count() == 0);
  REQUIRE(store.apply(r0, Update(2).motion(0, {1, 0, 0}).bytes()));
  CHECK(store.awake_count() == 1);
  CHECK_FALSE(store.sample_body(ball, at_tick(2))->asleep);
}

TEST_CASE("A region is complete from the update that says so until its link breaks") {
  ReplicaStore store(1);
  CHECK_FALSE(store.is_complete(r0));
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({}).bytes()));
  CHECK_FALSE(store.is_complete(r0));
  REQUIRE(store.apply(r0, Update(2).complete().bytes()));
  CHECK(store.is_complete(r0));
  REQUIRE(store.apply(r0, Update(3).bytes()));
  CHECK(store.is_complete(r0));
  CHECK(store.newest_tick(r0) == Tick{3});
  CHECK_FALSE(store.newest_tick(r1));
  store.region_down(r0);
  CHECK_FALSE(store.is_complete(r0));
  CHECK_FALSE(store.newest_tick(r0));
  store.region_up(r0);
  CHECK_FALSE(store.is_complete(r0));
}

TEST_CASE("The bodies of a region that is down stay where they were") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({.position = {5, 0, 0}}).bytes()));
  store.region_down(r0);
  CHECK(store.size() == 1);
  CHECK(store.owner_counts(r0).bodies == 1);
  CHECK(x_of(store, ball, 100) == 5);
}

TEST_CASE("A new link's slots start from nothing, also when the link was never said to be down") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({}).bytes()));
  store.region_up(r0);
  CHECK_FALSE(store.apply(r0, Update(2).motion(0, {1, 0, 0}).bytes()));
  CHECK(x_of(store, ball, 2) == 0);
}

TEST_CASE("A region that is not up has no say") {
  ReplicaStore store(1);
  CHECK_FALSE(store.apply(r0, Update(1).key({}).bytes()));
  store.region_up(r0);
  store.region_down(r0);
  CHECK_FALSE(store.apply(r0, Update(1).key({}).bytes()));
  CHECK(store.size() == 0);
}

TEST_CASE("A new link of the same owner may begin with an older state, which is not taken") {
  ReplicaStore store(1);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(9).key({.position = {9, 0, 0}}).bytes()));
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(8).key({.position = {8, 0, 0}}).bytes()));
  CHECK(store.key_state(ball)->tick == Tick{9});
  CHECK(x_of(store, ball, 9) == 9);
  REQUIRE(store.apply(r0, Update(8).motion(0, {8, 0, 0}).bytes()));
  CHECK(x_of(store, ball, 9) == 9);
  REQUIRE(store.apply(r0, Update(10).motion(0, {10, 0, 0}).bytes()));
  CHECK(x_of(store, ball, 10) == 10);
}

TEST_CASE("What an owner, linked anew, leaves out of its whole state is gone") {
  ReplicaStore store(1);
  const BodyId other = BodyId::world(77);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(1).key({}).key({.id = other, .slot = 1}).complete().bytes()));
  store.region_down(r0);
  store.region_up(r0);
  REQUIRE(store.apply(r0, Update(9).key({.id = other, .slot = 1}).bytes()));
  CHECK(store.size() == 2);  // Not before it has told everything.
  REQUIRE(store.apply(r0, Update(9).complete().bytes()));
  CHECK(store.size() == 1);
  CHECK(store.version(other));
  CHECK_FALSE(store.version(ball));
}

TEST_CASE("A body that has a new owner by then does not go with the old one's new link") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r0, Update(1).key({.version = version_of(r0, 1)}).complete().bytes()));
  store.region_up(r0);
  REQUIRE(store.apply(r1, Update(2).key({.version = version_of(r1, 2)}).complete().bytes()));
  REQUIRE(store.apply(r0, Update(2).complete().bytes()));
  CHECK(store.size() == 1);
}
