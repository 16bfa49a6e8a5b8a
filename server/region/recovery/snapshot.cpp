// Snapshots to bytes and back; what is read is checked like hostile input.
#include "server/region/recovery/snapshot.h"

#include <algorithm>

#include "protocol/wire.h"

namespace aureole {
namespace {

/// Grows with every change of meaning; an older one counts as none.
constexpr std::uint32_t snapshot_format = 1;
/// Of one kind in one snapshot; far more than queues and journals hold.
constexpr std::size_t messages_max = 65'536;
constexpr std::size_t gateways_max = 4096;

using MessageAt = flatbuffers::Offset<wire::SnapshotMessage>;

MessageAt add(flatbuffers::FlatBufferBuilder& builder, FrameType type, const Bytes& payload) {
  const auto* data = reinterpret_cast<const std::uint8_t*>(payload.data());
  return wire::CreateSnapshotMessage(builder, static_cast<std::uint16_t>(type),
                                     builder.CreateVector(data, payload.size()));
}

/// Copied, so that the message inside lies aligned. `room`: bytes that messages may still have.
/// Offsets may lead to one message again and again; memory is only for what was written.
Result<Bytes> payload_of(const wire::SnapshotMessage* message, std::size_t& room) {
  if (message == nullptr || message->payload() == nullptr) return Bytes{};
  const auto bytes =
      std::as_bytes(std::span(message->payload()->data(), message->payload()->size()));
  if (bytes.size() > room) return Error{"the snapshot names the same messages several times"};
  room -= bytes.size();
  return Bytes(bytes.begin(), bytes.end());
}

template <class Vector>
Status check_size(const Vector* vector, std::size_t max, const char* of) {
  if (vector != nullptr && vector->size() > max)
    return Error::format("the snapshot has {} {}; expected at most {}", vector->size(), of, max);
  return Ok{};
}

Result<std::vector<HandoffGroup>> read_groups(const flatbuffers::Vector<MessageAt>* messages,
                                              const SnapshotOwner& owner, std::size_t& room) {
  std::vector<HandoffGroup> groups;
  if (messages == nullptr) return groups;
  if (auto ok = check_size(messages, messages_max, "groups"); !ok) return ok.error();
  for (const wire::SnapshotMessage* message : *messages) {
    const auto payload = payload_of(message, room);
    if (!payload) return payload.error();
    auto group = decode_handoff(*payload, owner.prototypes, owner.statics);
    if (!group) return Error::format("in the snapshot: {}", group.error().message);
    groups.push_back(std::move(*group));
  }
  return groups;
}

Status read_journal(const wire::SnapshotPeer& peer, const SnapshotOwner& owner, std::size_t& room,
                    Snapshot::Peer& to) {
  if (peer.journal() == nullptr) return Ok{};
  if (auto ok = check_size(peer.journal(), messages_max, "messages"); !ok) return ok;
  for (const wire::SnapshotMessage* message : *peer.journal()) {
    const auto type = static_cast<FrameType>(message->type());
    auto copied = payload_of(message, room);
    if (!copied) return copied.error();
    Bytes& payload = *copied;
    Status status = Ok{};
    if (type == FrameType::handoff) {
      if (auto r = decode_handoff(payload, owner.prototypes, owner.statics); !r) status = r.error();
    } else if (type == FrameType::effects) {
      if (auto r = decode_effects(payload); !r) status = r.error();
    } else if (type == FrameType::commands) {
      if (auto r = decode_commands(payload); !r) status = r.error();
    } else {
      status = Error::format("a journal holds a message of type {}", message->type());
    }
    if (!status) return Error::format("in the snapshot: {}", status.error().message);
    to.journal.emplace_back(type, std::move(payload));
  }
  return Ok{};
}

Status read_peers(const wire::Snapshot& table, const SnapshotOwner& owner, std::size_t& room,
                  Snapshot& to) {
  if (table.peers() == nullptr) return Ok{};
  if (auto ok = check_size(table.peers(), owner.regions, "peers"); !ok) return ok;
  for (const wire::SnapshotPeer* peer : *table.peers()) {
    if (peer->region() >= owner.regions || peer->region() == owner.region.value)
      return Error::format("the snapshot names region {} as a peer of region {}", peer->region(),
                           owner.region.value);
    Snapshot::Peer& entry = to.peers.emplace_back();
    entry.region = RegionId{peer->region()};
    if (auto ok = read_journal(*peer, owner, room, entry); !ok) return ok;
    auto waiting = read_groups(peer->waiting(), owner, room);
    if (!waiting) return waiting.error();
    entry.waiting = std::move(*waiting);
  }
  return Ok{};
}

Status check_owner(const wire::Snapshot& table, const SnapshotOwner& owner) {
  if (table.format() != snapshot_format)
    return Error::format("the snapshot has format {}; expected {}", table.format(),
                         snapshot_format);
  if (table.world_hash() != owner.world_hash) return Error{"the snapshot is of another world"};
  if (table.region() != owner.region.value)
    return Error::format("the snapshot is of region {}; expected {}", table.region(),
                         owner.region.value);
  if (table.incarnation() == 0) return Error{"the snapshot is of no start of a region"};
  if (!is_wire_tick(table.tick()))
    return Error::format("the snapshot is of tick {}; expected at most {} from 0", table.tick(),
                         wire_tick_max);
  return Ok{};
}

}  // namespace

Bytes encode_snapshot(const Snapshot& snapshot, const SnapshotOwner& owner) {
  std::vector<Bytes> hosted;
  std::size_t bytes = 4096;
  for (const HandoffGroup& group : snapshot.hosted) {
    hosted.push_back(encode_handoff(group));
    bytes += hosted.back().size() + 64;
  }
  flatbuffers::FlatBufferBuilder builder(bytes);
  std::vector<MessageAt> hosted_at;
  for (const Bytes& payload : hosted)
    hosted_at.push_back(add(builder, FrameType::handoff, payload));

  std::vector<flatbuffers::Offset<wire::SnapshotPeer>> peers_at;
  for (const Snapshot::Peer& peer : snapshot.peers) {
    std::vector<MessageAt> journal, waiting;
    for (const auto& [type, payload] : peer.journal) journal.push_back(add(builder, type, payload));
    for (const HandoffGroup& group : peer.waiting)
      waiting.push_back(add(builder, FrameType::handoff, encode_handoff(group)));
    peers_at.push_back(wire::CreateSnapshotPeer(
        builder, peer.region.value, builder.CreateVector(journal), builder.CreateVector(waiting)));
  }
  std::vector<wire::SnapshotRemoval> removals;
  for (const auto& [id, tick] : snapshot.removals) removals.push_back({id.value, tick.value});
  EffectsMessage effects;
  effects.blasts = snapshot.blasts;
  const auto blasts_at = add(builder, FrameType::effects, encode_effects(effects));
  const auto hosted_vector = builder.CreateVector(hosted_at);
  const auto peers_vector = builder.CreateVector(peers_at);
  const auto injected_at = builder.CreateVector(snapshot.injected);
  const auto removals_at = builder.CreateVectorOfStructs(removals);
  const auto gateways_at = builder.CreateVector(snapshot.gateways);
  builder.Finish(wire::CreateSnapshot(builder, snapshot_format, owner.world_hash,
                                      owner.region.value, snapshot.incarnation.value,
                                      snapshot.tick.value, hosted_vector, peers_vector, injected_at,
                                      blasts_at, removals_at, gateways_at));
  const auto all = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {all.begin(), all.end()};
}

Result<Snapshot> decode_snapshot(std::span<const std::byte> bytes, const SnapshotOwner& owner) {
  const auto* table = verified<wire::Snapshot>(bytes);
  if (table == nullptr)
    return Error::format("{} bytes are not a valid snapshot of a region", bytes.size());
  if (auto ok = check_owner(*table, owner); !ok) return ok.error();
  Snapshot snapshot;
  snapshot.incarnation = Incarnation{table->incarnation()};
  snapshot.tick = Tick{table->tick()};
  std::size_t room = bytes.size();
  auto hosted = read_groups(table->hosted(), owner, room);
  if (!hosted) return hosted.error();
  snapshot.hosted = std::move(*hosted);
  if (auto ok = read_peers(*table, owner, room, snapshot); !ok) return ok.error();
  if (table->injected() == nullptr || table->injected()->size() != owner.injectors)
    return Error::format("the snapshot counts other injectors than the {} of this world",
                         owner.injectors);
  snapshot.injected.assign(table->injected()->begin(), table->injected()->end());
  if (table->blasts() != nullptr) {
    const auto payload = payload_of(table->blasts(), room);
    if (!payload) return payload.error();
    auto effects = decode_effects(*payload);
    if (!effects) return Error::format("in the snapshot: {}", effects.error().message);
    snapshot.blasts = std::move(effects->blasts);
  }
  if (table->removals() != nullptr) {
    if (auto ok = check_size(table->removals(), messages_max, "removals"); !ok) return ok.error();
    for (const wire::SnapshotRemoval* r : *table->removals()) {
      if (!BodyId{r->id()}.valid() || !is_wire_tick(r->tick()))
        return Error{"the snapshot removes a body that cannot be"};
      snapshot.removals.emplace_back(BodyId{r->id()}, Tick{r->tick()});
    }
  }
  if (table->gateways() != nullptr) {
    if (auto ok = check_size(table->gateways(), gateways_max, "gateways"); !ok) return ok.error();
    snapshot.gateways.assign(table->gateways()->begin(), table->gateways()->end());
  }
  return snapshot;
}

}  // namespace aureole
