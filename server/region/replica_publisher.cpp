// Encodes a region's bodies for the gateways.
#include "server/region/replica_publisher.h"

#include <algorithm>

#include "protocol/wire_values.h"
#include "server/base/check.h"

namespace aureole {
namespace {

using aureole::to_wire;

wire::ReplicaVersion to_wire(const Version& v) {
  return {v.epoch, v.region.value, v.incarnation.value};
}

wire::ReplicaKey make_key(const NewBody& b, const Version& version, std::uint32_t slot) {
  const BodyState& s = b.state;
  return {b.id.value,
          to_wire(version),
          slot,
          b.prototype.value,
          static_cast<std::uint8_t>(s.activation),
          to_wire(s.position),
          to_wire(s.orientation),
          to_wire(s.linear_velocity),
          to_wire(s.angular_velocity),
          s.deactivation_time_s};
}

wire::PlayerStatus to_wire(const Avatar& a) {
  return {a.player.value, a.session, a.applied_sequence, a.connected, a.carried.value};
}

SharedBytes frame_of(Tick now, bool complete, std::span<const wire::ReplicaKey> keys,
                     std::span<const wire::ReplicaMotion> motions,
                     std::span<const wire::ReplicaRemoved> removed,
                     std::span<const wire::PlayerStatus> players) {
  flatbuffers::FlatBufferBuilder builder(128 + keys.size_bytes() + motions.size_bytes() +
                                         removed.size_bytes() + players.size_bytes());
  const auto keys_at = builder.CreateVectorOfStructs(keys.data(), keys.size());
  const auto motions_at = builder.CreateVectorOfStructs(motions.data(), motions.size());
  const auto removed_at = builder.CreateVectorOfStructs(removed.data(), removed.size());
  const auto players_at = builder.CreateVectorOfStructs(players.data(), players.size());
  return std::make_shared<const Bytes>(
      finish_frame(builder,
                   wire::CreateReplicaUpdate(builder, now.value, complete, keys_at, motions_at,
                                             removed_at, players_at),
                   FrameType::replica_update));
}

}  // namespace

std::uint32_t ReplicaPublisher::take_slot() {
  if (free_slots_.empty()) return next_slot_++;
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  return slot;
}

void ReplicaPublisher::body_gained(BodyId id, Version version) {
  auto [it, fresh] = bodies_.try_emplace(id);
  AUREOLE_CHECK(fresh, "a body is published once");
  it->second.slot = take_slot();
  it->second.version = version;
}

void ReplicaPublisher::body_lost(BodyId id) {
  const auto it = bodies_.find(id);
  AUREOLE_CHECK(it != bodies_.end(), "only published bodies are lost");
  free_slots_.push_back(it->second.slot);
  bodies_.erase(it);
}

void ReplicaPublisher::body_removed(BodyId id, Version version) {
  body_lost(id);
  removed_.push_back({id, version});
}

SharedBytes ReplicaPublisher::update(Tick now, const PhysicsWorld& world,
                                     std::span<const Avatar* const> avatars) {
  std::vector<wire::ReplicaKey> keys;
  std::vector<wire::ReplicaMotion> motions;
  for (BodyId id : world.ids()) {
    Published& published = bodies_.at(id);
    const bool asleep = world.is_asleep(id);
    // Asleep and known to be: nothing has changed since.
    if (asleep && published.asleep && !published.key_due) continue;
    const BodyState state = world.state(id);
    const auto position = quantise(state.position);
    const auto orientation = quantise(state.orientation);
    const bool moved = position != published.position || orientation != published.orientation;
    const bool turn = !asleep && (now.value + published.slot) % key_interval_ticks == 0;
    const bool needs_key = published.key_due || asleep != published.asleep || turn;
    // More would not fit a frame together with everybody's motion; the rest comes a tick later.
    if (needs_key && keys.size() >= keys_per_update) continue;
    if (needs_key) {
      keys.push_back(make_key({id, world.prototype(id), state}, published.version, published.slot));
    } else if (moved) {
      flatbuffers::span<const std::uint8_t, 9> p(position.data(), 9);
      flatbuffers::span<const std::uint8_t, 6> q(orientation.data(), 6);
      motions.emplace_back(published.slot, p, q, std::uint8_t{0});
    }
    published.key_due = false;
    published.asleep = asleep;
    published.position = position;
    published.orientation = orientation;
  }

  std::vector<wire::ReplicaRemoved> removed;
  for (const auto& r : removed_) removed.push_back({r.id.value, to_wire(r.version)});
  removed_.clear();

  std::vector<wire::PlayerStatus> players;
  std::unordered_map<PlayerId, PlayerSent> now_known;
  for (const Avatar* a : avatars) {
    const PlayerSent sent{a->session, a->applied_sequence, a->connected, a->carried};
    const auto before = players_.find(a->player);
    if (before == players_.end() || !(before->second == sent)) players.push_back(to_wire(*a));
    now_known.emplace(a->player, sent);
  }
  players_ = std::move(now_known);
  return frame_of(now, true, keys, motions, removed, players);
}

std::vector<SharedBytes> ReplicaPublisher::whole_state(Tick now, const PhysicsWorld& world,
                                                       std::span<const VersionedBody> passive,
                                                       std::span<const Avatar* const> avatars) {
  std::vector<wire::ReplicaKey> keys;
  for (BodyId id : world.ids()) {
    const Published& published = bodies_.at(id);
    keys.push_back(
        make_key({id, world.prototype(id), world.state(id)}, published.version, published.slot));
  }
  // Copies in flight get slots that no motion will ever name.
  std::uint32_t spare = next_slot_;
  for (const auto& body : passive) keys.push_back(make_key(body.body, body.version, spare++));

  std::vector<wire::PlayerStatus> players;
  for (const Avatar* a : avatars) players.push_back(to_wire(*a));

  std::vector<SharedBytes> frames;
  std::size_t at = 0;
  do {
    const std::size_t count = std::min(keys_per_frame, keys.size() - at);
    const bool last = at + count == keys.size();
    frames.push_back(frame_of(now, last, std::span(keys).subspan(at, count), {}, {},
                              last ? std::span<const wire::PlayerStatus>(players)
                                   : std::span<const wire::PlayerStatus>()));
    at += count;
  } while (at < keys.size());
  return frames;
}

}  // namespace aureole
