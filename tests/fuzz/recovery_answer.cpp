// Recovery: whatever servers answer, what a region claims then can be hosted and is bounded.
#include <algorithm>

#include "protocol/wire.h"
#include "server/region/recovery/recovery.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/groups.h"

using namespace aureole;
using namespace aureole::fuzz;

namespace {

constexpr std::size_t regions = 3;
constexpr PeerId neighbour{1}, other{2};
constexpr PeerId gateway = PeerId::gateway(0);
constexpr Incarnation lived{5}, lives{6};

/// A region that recovers with what it had written down: five bodies, one of them an avatar.
Recovery a_recovery() {
  Snapshot snapshot;
  snapshot.incarnation = lived;
  snapshot.tick = Tick{600};
  snapshot.hosted.push_back(a_group(4, 1));
  Recovery recovery({RegionId{0}, lives, regions, prototypes, statics}, snapshot);
  for (const PeerId peer : {neighbour, other, gateway}) recovery.peer_up(peer, Incarnation{1});
  FUZZ_EXPECT(recovery.ask(Tick{700}).size() == 3 && recovery.round() == 1);
  return recovery;
}

void check(const Recovery& recovery, std::size_t size) {
  const Recovery::Outcome outcome = recovery.decide(Tick{701});
  FUZZ_EXPECT(outcome.known.size() <= 5 + size / 8);
  FUZZ_EXPECT(outcome.heard.value >= -1 && outcome.heard.value <= wire_tick_max);
  for (std::size_t i = 0; i < outcome.bodies.size(); ++i) {
    const HandoffGroup::Body& b = outcome.bodies[i];
    FUZZ_EXPECT(i == 0 || outcome.bodies[i - 1].body.id < b.body.id);
    FUZZ_EXPECT(b.body.id.valid() && b.body.prototype.value < prototypes);
    FUZZ_EXPECT(may_travel(b.body.state) && outcome.known.contains(b.body.id));
  }
  std::set<PlayerId> players;
  for (const Avatar& avatar : outcome.avatars) {
    FUZZ_EXPECT(players.insert(avatar.player).second && avatar.player.value != 0);
    FUZZ_EXPECT(std::any_of(outcome.bodies.begin(), outcome.bodies.end(),
                            [&](const auto& b) { return b.body.id == avatar.body(); }));
    FUZZ_EXPECT(avatar.session <= session_max);
    // Its next thing has a name that is free.
    FUZZ_EXPECT(!outcome.known.contains(BodyId::thrown(avatar.player, avatar.thrown)));
  }
  for (const KnownState& state : recovery.candidates())
    FUZZ_EXPECT(state.version.region.value == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes payload = payload_of(data, size);
  const auto round = decode_recovery_query(payload);
  FUZZ_EXPECT(!round || *round != 0);
  for (const PeerId from : {neighbour, gateway}) {
    Recovery recovery = a_recovery();
    const bool taken = bool(recovery.hear_answer(from, payload));
    check(recovery, size);
    if (!taken) FUZZ_EXPECT(recovery.decide(Tick{701}).bodies.size() == 5);
    // An answer that comes again tells nothing new, whoever else recovers.
    const std::size_t known = recovery.decide(Tick{701}).known.size();
    FUZZ_EXPECT(bool(recovery.hear_answer(from, payload)) == taken);
    FUZZ_EXPECT(recovery.decide(Tick{701}).known.size() == known);
    FUZZ_EXPECT(bool(recovery.hear_answer(other, payload)) == taken);
    recovery.peer_down(from);
    static_cast<void>(recovery.ask(Tick{702}));
    static_cast<void>(recovery.waits_for(Tick{702}));
    check(recovery, size);
  }
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  const auto version = [](std::uint32_t epoch, Incarnation incarnation, std::uint16_t region) {
    return Version{epoch, incarnation, RegionId{region}};
  };
  RecoveryAnswer done, traces, states, all;
  done.round = 0;
  traces.round = states.round = all.round = 1;
  traces.traces = {{BodyId::world(10), version(9, Incarnation{1}, 1), false},
                   {BodyId::world(11), version(40, lived, 0), true},
                   {BodyId::world(50), version(2, lived, 0), false},
                   {BodyId::thrown(PlayerId{1}, 0), version(2, lived, 0), false}};
  const HandoffGroup group = a_group(20, 2);
  states.recovering = true;
  for (const auto& b : group.bodies) {
    states.states.push_back({b.body, version(b.epoch, Incarnation{1}, 1)});
    all.states.push_back({b.body, version(b.epoch + 5, lived, 0)});
  }
  all.heard = Tick{650};
  all.players = {{PlayerId{1}, 12, 36, BodyId::world(12)}, {PlayerId{2}, 13, 1, {}}};
  std::vector<Bytes> seeds;
  for (const RecoveryAnswer& answer : {done, traces, states, all})
    seeds.push_back(Frame(*decode_frame(*encode_recovery_answer(answer).front())).payload);
  seeds.push_back(Frame(*decode_frame(*encode_recovery_query(3))).payload);
  return seeds;
}
