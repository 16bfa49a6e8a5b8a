// Several regions speak of one body: the higher version wins, in whatever order they are heard.
#include <algorithm>
#include <map>
#include <random>

#include "server/replica/replica_store.h"
#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {
double newest_x(const ReplicaStore& store, BodyId id) {
  return store.sample_body(id, at_tick(1'000'000))->position.x;
}
}  // namespace

TEST_CASE("A lower version is not taken, but its slot is known and moves nobody") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(
      r1, Update(5).key({.version = version_of(r1, 2), .position = {1, 0, 0}}).bytes()));
  REQUIRE(store.apply(r0, Update(5).key({.version = version_of(r0, 1), .slot = 3}).bytes()));
  REQUIRE(store.apply(r0, Update(6).motion(3, {7, 0, 0}).bytes()));
  CHECK(store.version(ball) == version_of(r1, 2));
  CHECK(newest_x(store, ball) == 1);
  CHECK(store.owner_counts(r0).bodies == 0);
  CHECK(store.owner_counts(r1).bodies == 1);
}

TEST_CASE("When a body has a new owner, motions of the old one are of no account") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r0, Update(5).key({.version = version_of(r0, 1), .slot = 3}).bytes()));
  REQUIRE(store.apply(
      r1, Update(5).key({.version = version_of(r1, 2), .position = {1, 0, 0}}).bytes()));
  REQUIRE(store.apply(r0, Update(6).motion(3, {7, 0, 0}).bytes()));
  CHECK(newest_x(store, ball) == 1);
  CHECK(store.sample_body(ball, at_tick(6))->owner == r1);
  CHECK(store.owner_counts(r0).bodies == 0);
  CHECK(store.owner_counts(r1).awake == 1);
}

TEST_CASE("A region that takes a body back under a higher version needs a new key for its slot") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r0, Update(5).key({.version = version_of(r0, 1), .slot = 3}).bytes()));
  REQUIRE(store.apply(r1, Update(5).key({.version = version_of(r1, 2)}).bytes()));
  REQUIRE(store.apply(r0, Update(6).key({.version = version_of(r0, 3), .slot = 4}).bytes()));
  REQUIRE(store.apply(r0, Update(7).motion(3, {7, 0, 0}).bytes()));
  CHECK(newest_x(store, ball) == 0);
  REQUIRE(store.apply(r0, Update(8).motion(4, {8, 0, 0}).bytes()));
  CHECK(newest_x(store, ball) == 8);
}

TEST_CASE("Incarnation comes before region when epochs are equal") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r1, Update(5).key({.version = version_of(r1, 2, 1)}).bytes()));
  REQUIRE(store.apply(r0, Update(5).key({.version = version_of(r0, 2, 2)}).bytes()));
  CHECK(store.version(ball)->region == r0);
}

TEST_CASE("A new owner whose clock is behind replaces the poses that are later than its own") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(
      r0, Update(8).key({.version = version_of(r0, 1), .position = {8, 0, 0}}).bytes()));
  REQUIRE(store.apply(r0, Update(9).motion(0, {9, 0, 0}).bytes()));
  REQUIRE(store.apply(r0, Update(10).motion(0, {10, 0, 0}).bytes()));
  REQUIRE(store.apply(
      r1, Update(9).key({.version = version_of(r1, 2), .position = {4, 0, 0}}).bytes()));
  CHECK(store.sample_body(ball, at_tick(10))->position.x == 4);
  CHECK(store.sample_body(ball, at_tick(8.5))->position.x == 6);
  CHECK(store.sample_body(ball, at_tick(8))->position.x == 8);
}

TEST_CASE(
    "Removal needs at least the version held, and an older key does not bring the body back") {
  ReplicaStore store(1);
  for (RegionId r : {r0, r1, r2}) store.region_up(r);
  REQUIRE(store.apply(r1, Update(5).key({.version = version_of(r1, 2)}).bytes()));
  REQUIRE(store.apply(r0, Update(5).removed(ball, version_of(r0, 1)).bytes()));
  CHECK(store.size() == 1);
  REQUIRE(store.apply(r1, Update(6).removed(ball, version_of(r1, 2)).bytes()));
  CHECK(store.size() == 0);
  CHECK(store.awake_count() == 0);
  REQUIRE(store.apply(r0, Update(6).key({.version = version_of(r0, 1), .slot = 8}).bytes()));
  REQUIRE(store.apply(r0, Update(7).motion(8, {1, 0, 0}).bytes()));
  CHECK(store.size() == 0);
  REQUIRE(store.apply(r2, Update(7).key({.version = version_of(r2, 3)}).bytes()));
  CHECK(store.version(ball) == version_of(r2, 3));
}

TEST_CASE("A removal that is heard before the body's last key wins all the same") {
  ReplicaStore store(1);
  store.region_up(r0);
  store.region_up(r1);
  REQUIRE(store.apply(r1, Update(5).removed(ball, version_of(r1, 2)).bytes()));
  REQUIRE(store.apply(r0, Update(5).key({.version = version_of(r0, 1)}).bytes()));
  CHECK(store.size() == 0);
}

namespace {

/// Streams of three regions that hand twelve bodies round, with everything that may happen to them:
/// sleep, waking, journal copies of an older version, removal.
struct Streams {
  std::map<RegionId, std::vector<Bytes>> of;
  std::map<BodyId, std::int64_t> last_taken_over;
};

Streams make_streams(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  struct Body {
    Version version;
    WorldPosition position;
    bool asleep = false;
    bool removed = false;
    bool moved = false;  // to another owner, this tick
    bool told = false;
  };
  constexpr std::uint32_t body_count = 12;
  std::vector<Body> bodies(body_count);
  std::vector<std::pair<std::uint32_t, Version>> left;  // journal copies that are told once more
  Streams streams;
  for (auto& body : bodies) body.version = version_of(RegionId{std::uint16_t(random() % 3)}, 1);
  for (std::int64_t tick = 1; tick <= 40; ++tick) {
    left.clear();
    for (std::uint32_t n = 0; n < body_count; ++n) {
      Body& body = bodies[n];
      body.moved = !body.told;
      if (tick > 1 && !body.removed && random() % 10 == 0) {
        left.emplace_back(n, body.version);
        body.version =
            version_of(RegionId{std::uint16_t((body.version.region.value + 1 + random() % 2) % 3)},
                       body.version.epoch + 1);
        body.moved = true;
        streams.last_taken_over[BodyId::world(n)] = tick;
      }
    }
    std::map<RegionId, Update> updates;
    for (RegionId r : {r0, r1, r2}) updates.emplace(r, Update(tick));
    for (auto& [n, version] : left)
      if (random() % 2 == 0)
        updates.at(version.region)
            .key({.id = BodyId::world(n), .version = version, .slot = n, .position = {-1, -1, -1}});
    for (std::uint32_t n = 0; n < body_count; ++n) {
      Body& body = bodies[n];
      if (body.removed) continue;
      Update& update = updates.at(body.version.region);
      const bool fell_asleep = !body.asleep && random() % 8 == 0;
      const bool woke = body.asleep && random() % 4 == 0;
      body.asleep = (body.asleep || fell_asleep) && !woke;
      if (!body.asleep) body.position = {double(random() % 1000) / 7, double(tick), 0};
      const std::uint8_t activation = body.asleep ? 2 : 0;
      if (body.moved || fell_asleep || woke)
        update.key({.id = BodyId::world(n),
                    .version = body.version,
                    .slot = n,
                    .position = body.position,
                    .activation = activation});
      else if (!body.asleep)
        update.motion(n, body.position);
      body.told = true;
      if (tick > 20 && random() % 60 == 0) {
        update.removed(BodyId::world(n), body.version);
        body.removed = true;
      }
    }
    for (auto& [r, update] : updates) streams.of[r].push_back(update.bytes());
  }
  return streams;
}

/// All streams, each in its own order, mixed at random.
ReplicaStore heard(const Streams& streams, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ReplicaStore store(1);
  std::vector<RegionId> turns;
  std::map<RegionId, std::size_t> next;
  for (const auto& [r, updates] : streams.of) {
    store.region_up(r);
    turns.insert(turns.end(), updates.size(), r);
  }
  std::shuffle(turns.begin(), turns.end(), random);
  for (RegionId r : turns) REQUIRE(store.apply(r, streams.of.at(r)[next[r]++]));
  return store;
}

}  // namespace

TEST_CASE("In whatever order the regions are heard, the store ends up with the same bodies") {
  for (std::uint64_t world = 0; world < 20; ++world) {
    const Streams streams = make_streams(world);
    const ReplicaStore reference = heard(streams, 0);
    std::vector<ReplicaPose> expected;
    reference.sample(at_tick(40), expected);
    for (std::uint64_t order = 1; order < 20; ++order) {
      const ReplicaStore store = heard(streams, order);
      REQUIRE(store.size() == reference.size());
      REQUIRE(store.awake_count() == reference.awake_count());
      for (RegionId r : {r0, r1, r2}) {
        REQUIRE(store.owner_counts(r).bodies == reference.owner_counts(r).bodies);
        REQUIRE(store.owner_counts(r).awake == reference.owner_counts(r).awake);
      }
      std::vector<ReplicaPose> poses;
      store.sample(at_tick(40), poses);
      REQUIRE(poses.size() == expected.size());
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const BodyId id = expected[i].id;
        REQUIRE(poses[i].id == id);
        REQUIRE(poses[i].position == expected[i].position);
        REQUIRE(poses[i].owner == expected[i].owner);
        REQUIRE(poses[i].asleep == expected[i].asleep);
        REQUIRE(store.version(id) == reference.version(id));
        REQUIRE(store.key_state(id)->tick == reference.key_state(id)->tick);
        // From the last change of owner on, the way there is the same too. (Earlier poses come from
        // owners that may have been heard too late.)
        const auto taken_over = streams.last_taken_over.find(id);
        const double since =
            taken_over == streams.last_taken_over.end() ? 1 : double(taken_over->second);
        for (double tick = std::max(since, 33.0); tick <= 40; tick += 0.25)
          REQUIRE(store.sample_body(id, at_tick(tick))->position ==
                  reference.sample_body(id, at_tick(tick))->position);
      }
    }
  }
}
