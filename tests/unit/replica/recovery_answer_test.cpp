// What a store tells a region that starts anew after its death.
#include "server/replica/recovery_answer.h"

#include "protocol/wire.h"
#include "tests/support/catch.h"
#include "update.h"

using namespace aureole;
using namespace aureole::test;

namespace {

Bytes query(std::uint64_t round) {
  flatbuffers::FlatBufferBuilder builder(64);
  builder.Finish(wire::CreateRecoveryQuery(builder, round));
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {bytes.begin(), bytes.end()};
}

/// The only frame of the answer to region 0 in round 3.
Frame answer_of(const ReplicaStore& store) {
  auto frames = answer_recovery(store, r0, query(3));
  REQUIRE(frames);
  REQUIRE(frames->size() == 1);
  return *decode_frame(*frames->front());
}

}  // namespace

TEST_CASE("a store tells a region that recovers the newest states, removals and its last tick") {
  ReplicaStore store(4);
  store.region_up(r0);
  store.region_up(r1);
  Key rolling;
  rolling.slot = 1;
  rolling.linear_velocity = {9, 0, 0};
  Key elsewhere;
  elsewhere.id = box;
  elsewhere.version = version_of(r1, 5);
  REQUIRE(store.apply(r1, Update(12).key(elsewhere).bytes()));
  REQUIRE(store.apply(r0, Update(10).key(rolling).bytes()));
  REQUIRE(store.apply(r0, Update(11).motion(1, {0.1, 0, 0}).bytes()));
  REQUIRE(store.apply(r0, Update(12).motion(1, {0.2, 0, 0}).bytes()));
  REQUIRE(store.apply(r1, Update(13).removed(BodyId::world(9), version_of(r1, 2)).bytes()));
  store.region_down(r0);
  store.region_up(r0);

  const Frame frame = answer_of(store);
  REQUIRE(frame.type == FrameType::recovery_answer);
  const auto* answer = verified<wire::RecoveryAnswer>(frame.payload);
  REQUIRE(answer != nullptr);
  REQUIRE(answer->round() == 3);
  REQUIRE(answer->complete());
  REQUIRE_FALSE(answer->recovering());
  REQUIRE(answer->heard_tick() == 12);
  REQUIRE(answer->states()->size() == 2);
  const wire::ReplicaKey* moved = answer->states()->Get(1);
  REQUIRE(moved->id() == ball.value);
  REQUIRE(moved->position().x() == Approx(0.2).margin(0.001));
  // The key's 9 m/s are two ticks old; the poses say 0.1 m a tick.
  REQUIRE(moved->linear_velocity().x() == Approx(6.25f).margin(0.07));
  REQUIRE(answer->traces()->size() == 1);
  REQUIRE(answer->traces()->Get(0)->id() == BodyId::world(9).value);
  REQUIRE(answer->traces()->Get(0)->removed());
}

TEST_CASE("a store that knows nothing says so in one complete answer") {
  const Frame frame = answer_of(ReplicaStore(4));
  const auto* answer = verified<wire::RecoveryAnswer>(frame.payload);
  REQUIRE(answer->complete());
  REQUIRE(answer->heard_tick() == -1);
  REQUIRE(answer->states()->size() == 0);
}

TEST_CASE("a store with more bodies than a frame holds answers in several") {
  ReplicaStore store(4);
  store.region_up(r0);
  Update update(1);
  for (std::uint32_t n = 0; n < 40'000; ++n) {
    Key key;
    key.id = BodyId::world(n);
    key.slot = n;
    update.key(key);
  }
  REQUIRE(store.apply(r0, update.bytes()));
  const auto frames = answer_recovery(store, r0, query(1));
  REQUIRE(frames->size() == 2);
  std::size_t states = 0;
  for (const SharedBytes& bytes : *frames) {
    const Frame frame = *decode_frame(*bytes);
    const auto* answer = verified<wire::RecoveryAnswer>(frame.payload);
    REQUIRE(answer->complete() == (bytes == frames->back()));
    states += answer->states()->size();
  }
  REQUIRE(states == 40'000);
}

TEST_CASE("what is no recovery query is refused") {
  REQUIRE_FALSE(answer_recovery(ReplicaStore(4), r0, query(0)));
  REQUIRE_FALSE(answer_recovery(ReplicaStore(4), r0, Bytes(16, std::byte{7})));
}
