// decode_snapshot: whatever lies on the disk, a region that begins from it claims what can be.
#include "protocol/wire_values.h"
#include "server/region/recovery/recovery.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/groups.h"

using namespace aureole;
using namespace aureole::fuzz;

namespace {

const SnapshotOwner owner{0xabc, RegionId{0}, 3, prototypes, statics, 2};

/// What has been read takes no more than a multiple of the bytes that said it.
void check_size(const Snapshot& snapshot, std::size_t size) {
  std::size_t bodies = 0, journal = 0;
  for (const HandoffGroup& group : snapshot.hosted) bodies += group.bodies.size();
  for (const Snapshot::Peer& peer : snapshot.peers) {
    for (const HandoffGroup& group : peer.waiting) bodies += group.bodies.size();
    for (const auto& [type, payload] : peer.journal) journal += payload.size();
  }
  FUZZ_EXPECT(bodies * sizeof(wire::HandoffBody) + journal <= size);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  const auto snapshot = decode_snapshot(Bytes(input.begin(), input.end()), owner);
  if (!snapshot) {
    FUZZ_EXPECT(!snapshot.error().message.empty());
    return 0;
  }
  check_size(*snapshot, size);
  FUZZ_EXPECT(snapshot->incarnation.value != 0 && snapshot->injected.size() == owner.injectors);
  FUZZ_EXPECT(is_wire_tick(snapshot->tick.value));
  for (const BlastEffect& blast : snapshot->blasts) FUZZ_EXPECT(is_wire_tick(blast.tick.value));
  for (const auto& [id, tick] : snapshot->removals)
    FUZZ_EXPECT(id.valid() && is_wire_tick(tick.value));
  // It can be written again, and is then the same.
  const Bytes again = encode_snapshot(*snapshot, owner);
  const auto same = decode_snapshot(again, owner);
  FUZZ_EXPECT(same && encode_snapshot(*same, owner) == again);

  const Recovery recovery({RegionId{0}, Incarnation{9}, owner.regions, prototypes, statics},
                          *snapshot);
  for (const HandoffGroup::Body& b : recovery.decide(Tick{700}).bodies)
    FUZZ_EXPECT(may_travel(b.body.state) && b.body.prototype.value < prototypes);
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  Snapshot empty, full;
  empty.incarnation = full.incarnation = Incarnation{5};
  empty.tick = full.tick = Tick{600};
  empty.injected = full.injected = {10, 20};
  full.hosted = {a_group(3, 1), a_group(2, 0)};
  EffectsMessage effects;
  effects.blasts.push_back({1, Tick{610}, {1, 2, 3}, 9, 13, BodyId::avatar(PlayerId{1})});
  effects.removals.push_back(BodyId::thrown(PlayerId{1}, 2));
  const PlayerCommand command = a_command(1, 36);
  Snapshot::Peer peer;
  peer.region = RegionId{1};
  peer.journal = {{FrameType::handoff, encode_handoff(a_group(2, 1))},
                  {FrameType::effects, encode_effects(effects)},
                  {FrameType::commands, encode_commands(std::span(&command, 1))}};
  peer.waiting = {a_group(1, 0)};
  full.peers.push_back(peer);
  full.blasts = effects.blasts;
  full.removals.emplace_back(BodyId::thrown(PlayerId{1}, 2), Tick{590});
  full.gateways = {0, 3};
  Snapshot never = full;
  never.removals[0].second = Tick{INT64_MIN};
  return {encode_snapshot(empty, owner), encode_snapshot(full, owner),
          encode_snapshot(never, owner)};
}
