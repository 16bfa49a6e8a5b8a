// Snapshots and recovery answers as bytes: whole, bounded, and checked when they are read.
#include <random>

#include "protocol/wire.h"
#include "server/region/recovery/answer.h"
#include "server/region/recovery/recovery.h"
#include "server/region/recovery/snapshot.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

NewBody body(std::uint32_t n) {
  NewBody b{BodyId::world(n), PrototypeId{1}, {}};
  b.state.position = {n * 0.5, 1, -2};
  b.state.linear_velocity = {1, 2, 3};
  return b;
}

Snapshot small_snapshot() {
  Snapshot s;
  s.incarnation = Incarnation{5};
  s.tick = Tick{600};
  HandoffGroup group;
  group.tick = s.tick;
  for (std::uint32_t n = 0; n < 3; ++n) group.bodies.push_back({body(n), 4 + n, 7});
  NewBody avatar_body = body(0);
  avatar_body.id = BodyId::avatar(PlayerId{9});
  group.bodies.push_back({avatar_body, 77, 0});
  Avatar avatar;
  avatar.player = PlayerId{9};
  avatar.session = 12;
  avatar.applied_sequence = 34;
  PlayerCommand waiting;
  waiting.player = avatar.player;
  waiting.session = 12;
  waiting.sequence = 36;
  avatar.waiting.emplace(36, waiting);
  group.avatars.push_back(avatar);
  s.hosted.push_back(group);
  Snapshot::Peer peer;
  peer.region = RegionId{1};
  group.avatars.clear();
  group.bodies.pop_back();
  peer.journal.emplace_back(FrameType::handoff, encode_handoff(group));
  peer.journal.emplace_back(FrameType::commands, encode_commands(std::span(&waiting, 1)));
  peer.waiting.push_back(group);
  s.peers.push_back(peer);
  s.injected = {10, 20};
  s.blasts.push_back({1, Tick{610}, {1, 2, 3}, 9, 13, BodyId::avatar(PlayerId{9})});
  s.removals.emplace_back(BodyId::thrown(PlayerId{9}, 2), Tick{590});
  s.gateways = {0, 3};
  return s;
}

const SnapshotOwner owner{0xabc, RegionId{0}, 2, 4, 1, 2};

}  // namespace

TEST_CASE("a snapshot reads back as it was written") {
  const Snapshot s = small_snapshot();
  const auto read = decode_snapshot(encode_snapshot(s, owner), owner);
  REQUIRE(read);
  REQUIRE(read->incarnation == s.incarnation);
  REQUIRE(read->tick == s.tick);
  REQUIRE(read->hosted.size() == 1);
  REQUIRE(read->hosted[0].bodies.size() == 4);
  REQUIRE(read->hosted[0].bodies[2].epoch == 6);
  REQUIRE(read->hosted[0].bodies[2].still_ticks == 7);
  REQUIRE(read->hosted[0].bodies[2].body.state.position ==
          s.hosted[0].bodies[2].body.state.position);
  REQUIRE(read->hosted[0].avatars[0].applied_sequence == 34);
  REQUIRE(read->hosted[0].avatars[0].waiting.contains(36));
  REQUIRE(read->peers[0].journal == s.peers[0].journal);
  REQUIRE(read->peers[0].waiting[0].bodies.size() == 3);
  REQUIRE(read->injected == s.injected);
  REQUIRE(read->blasts[0].tick == Tick{610});
  REQUIRE(read->removals == s.removals);
  REQUIRE(read->gateways == s.gateways);
}

TEST_CASE("a snapshot of another world, region or number of injectors is refused in a sentence") {
  const Bytes bytes = encode_snapshot(small_snapshot(), owner);
  SnapshotOwner other = owner;
  other.world_hash = 1;
  REQUIRE(decode_snapshot(bytes, other).error().message == "the snapshot is of another world");
  other = owner;
  other.region = RegionId{1};
  REQUIRE(decode_snapshot(bytes, other).error().message ==
          "the snapshot is of region 0; expected 1");
  other = owner;
  other.injectors = 3;
  REQUIRE_FALSE(decode_snapshot(bytes, other));
  other = owner;
  other.prototypes = 1;
  REQUIRE_FALSE(decode_snapshot(bytes, other));
}

TEST_CASE("no damage to a snapshot or an answer is worse than a refusal") {
  std::minstd_rand random(3);
  RecoveryAnswer answer;
  answer.round = 2;
  for (std::uint32_t n = 0; n < 20; ++n) {
    answer.traces.push_back({BodyId::world(n), {n, Incarnation{1}, RegionId{1}}, n % 2 == 0});
    answer.states.push_back({body(n), {n, Incarnation{1}, RegionId{0}}});
  }
  answer.players.push_back({PlayerId{4}, 5, 6, BodyId::world(1)});
  const Bytes snapshot = encode_snapshot(small_snapshot(), owner);
  const Bytes payload = Frame(*decode_frame(*encode_recovery_answer(answer).front())).payload;
  REQUIRE(decode_recovery_answer(payload, 2, 4));
  for (int n = 0; n < 5000; ++n) {
    Bytes bad = n % 2 == 0 ? snapshot : payload;
    for (unsigned flips = 1 + random() % 4; flips > 0; --flips)
      bad[random() % bad.size()] = static_cast<std::byte>(random());
    if (random() % 8 == 0) bad.resize(random() % bad.size());
    if (n % 2 == 0) {
      if (const auto read = decode_snapshot(bad, owner))
        for (const auto& group : read->hosted)
          for (const auto& b : group.bodies) REQUIRE(may_travel(b.body.state));
    } else if (const auto read = decode_recovery_answer(bad, 2, 4)) {
      for (const auto& state : read->states) {
        REQUIRE(may_travel(state.body.state));
        REQUIRE(state.version.region.value < 2);
        REQUIRE(state.body.prototype.value < 4);
      }
    }
  }
}

TEST_CASE("a snapshot that names one group many times is refused before it fills the memory") {
  const Bytes group = encode_handoff(small_snapshot().hosted[0]);
  const auto snapshot_of = [&](std::size_t times) {
    flatbuffers::FlatBufferBuilder builder;
    const auto* data = reinterpret_cast<const std::uint8_t*>(group.data());
    const auto payload = builder.CreateVector(data, group.size());
    const auto message = wire::CreateSnapshotMessage(builder, 6, payload);
    const auto hosted = builder.CreateVector(std::vector(times, message));
    const auto injected = builder.CreateVector(std::vector<std::uint64_t>{1, 2});
    builder.Finish(
        wire::CreateSnapshot(builder, 1, owner.world_hash, 0, 5, 600, hosted, 0, injected));
    const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
    return Bytes(bytes.begin(), bytes.end());
  };
  REQUIRE(decode_snapshot(snapshot_of(1), owner));
  REQUIRE(decode_snapshot(snapshot_of(2000), owner).error().message ==
          "the snapshot names the same messages several times");
}

TEST_CASE("a recovering region hears of no more bodies and players than a world can have") {
  Recovery recovery({RegionId{0}, Incarnation{2}, 2, 4, 1}, std::nullopt);
  const PeerId gateway = PeerId::gateway(0);
  recovery.peer_up(gateway, Incarnation{1});
  const auto hear = [&](const RecoveryAnswer& answer) {
    for (const SharedBytes& frame : encode_recovery_answer(answer))
      if (!recovery.hear_answer(gateway, decode_frame(*frame)->payload)) return false;
    return true;
  };
  const auto frames_until_refused = [&](auto fill) {
    std::uint32_t next = 1;
    for (std::size_t frames = 0;; ++frames) {
      RecoveryAnswer answer;
      answer.round = 1;
      for (int n = 0; n < 50'000; ++n) fill(answer, next++);
      if (!hear(answer)) return frames;
      REQUIRE(frames < 100);
    }
  };
  REQUIRE(frames_until_refused([](RecoveryAnswer& answer, std::uint32_t n) {
            answer.players.push_back({PlayerId{n}, 5, 6, {}});
          }) == 2 * Recovery::known_max / 50'000);
  REQUIRE(frames_until_refused([](RecoveryAnswer& answer, std::uint32_t n) {
            answer.traces.push_back({BodyId::world(n), {1, Incarnation{1}, RegionId{1}}, false});
          }) == 2 * Recovery::known_max / 50'000);
  // Nor by groups that neighbours hand over meanwhile.
  HandoffGroup group;
  group.bodies.push_back({body(0), 1});
  REQUIRE_FALSE(recovery.hear_group(group));
  REQUIRE(hear({}));
}

TEST_CASE("an answer of regions or prototypes that this world does not have is refused") {
  RecoveryAnswer answer;
  answer.round = 1;
  answer.states.push_back({body(1), {1, Incarnation{1}, RegionId{1}}});
  const Bytes payload = Frame(*decode_frame(*encode_recovery_answer(answer).front())).payload;
  REQUIRE(decode_recovery_answer(payload, 2, 2));
  REQUIRE_FALSE(decode_recovery_answer(payload, 1, 2));
  REQUIRE_FALSE(decode_recovery_answer(payload, 2, 1));
}

TEST_CASE("a large answer comes in several frames, the last of which is complete") {
  RecoveryAnswer answer;
  answer.round = 1;
  for (std::uint32_t n = 0; n < 70'000; ++n)
    answer.traces.push_back({BodyId::world(n), {1, Incarnation{1}, RegionId{0}}, false});
  const auto frames = encode_recovery_answer(answer);
  REQUIRE(frames.size() == 2);
  std::size_t traces = 0;
  for (const SharedBytes& frame : frames) {
    const auto part = decode_recovery_answer(decode_frame(*frame)->payload, 1, 1);
    REQUIRE(part->complete == (frame == frames.back()));
    traces += part->traces.size();
  }
  REQUIRE(traces == 70'000);
}
