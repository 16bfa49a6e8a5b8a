// Telling and hearing auras: differences on the wire, whole sets in memory.
#include "server/region/aura_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/quantise.h"
#include "protocol/wire.h"

namespace aureole {
namespace {

/// Half extents travel in steps of 1/64 m.
constexpr double extent_step_m = 1.0 / 64;

/// Rounded up, and by the error of the quantised centre: the receiver's box holds the sender's.
std::uint16_t quantise_extent(double metres) {
  const double steps = std::ceil((metres + position_error_m) / extent_step_m);
  return static_cast<std::uint16_t>(std::clamp(steps, 0.0, 65'535.0));
}

RemoteAura from_wire(const wire::Aura& aura, RegionId host) {
  QuantisedPosition position;
  for (std::size_t i = 0; i < position.size(); ++i)
    position[i] = aura.position()->Get(static_cast<flatbuffers::uoffset_t>(i));
  RemoteAura remote{BodyId{aura.id()}, host, {}, aura.asleep() != 0};
  remote.box.centre = dequantise(position).vector();
  for (flatbuffers::uoffset_t axis = 0; axis < 3; ++axis)
    remote.box.half[axis] = aura.half_extents()->Get(axis) * extent_step_m;
  return remote;
}

}  // namespace

void AuraExchange::link_up(RegionId id) {
  peers_[id] = {};
  peers_[id].up = true;
  changed_ = true;
}

void AuraExchange::link_down(RegionId id) {
  peers_[id] = {};
  changed_ = true;
}

Result<Tick> AuraExchange::receive(RegionId from, std::span<const std::byte> payload) {
  const auto* message = verified<wire::Auras>(payload);
  if (message == nullptr) return Error{"an auras message is not valid"};
  Told told;
  const auto too_many = [](const auto* list) {
    return list != nullptr && list->size() > max_auras;
  };
  if (too_many(message->auras()) || too_many(message->removed()) || too_many(message->pulls()))
    return Error::format("more than {} auras in one message", max_auras);
  if (message->auras() != nullptr) {
    for (const auto* aura : *message->auras()) {
      if (!BodyId{aura->id()}.valid()) return Error{"an aura of a body that cannot be"};
      told.auras.push_back(from_wire(*aura, from));
    }
  }
  if (message->removed() != nullptr)
    for (std::uint64_t id : *message->removed()) told.removed.push_back(BodyId{id});
  if (message->pulls() != nullptr)
    for (std::uint64_t id : *message->pulls()) told.pulls.push_back(BodyId{id});
  const Tick told_at{message->tick()};
  if (told.auras.empty() && told.removed.empty() && told.pulls.empty()) return told_at;
  Peer& peer = peers_[from];
  if (peer.theirs.size() + told.auras.size() > 4 * max_auras)
    return Error{"a region projects more auras than a world can hold"};
  for (const RemoteAura& aura : told.auras) peer.theirs.insert_or_assign(aura.id, aura);
  for (BodyId gone : told.removed) peer.theirs.erase(gone);
  // Only the newest message's requests are still meant: they are repeated until they are met.
  peer.pulls = std::move(told.pulls);
  changed_ = true;
  return told_at;
}

std::vector<HandoverRequest> AuraExchange::take_in() {
  if (!changed_) return {};
  std::map<BodyId, RegionId> requested;
  std::map<BodyId, RemoteAura> all;
  for (auto& [id, peer] : peers_) {
    for (BodyId body : peer.pulls) requested.try_emplace(body, id);
    peer.pulls.clear();
    for (const auto& [body, aura] : peer.theirs) all.try_emplace(body, aura);
  }
  remote_.clear();
  for (const auto& [body, aura] : all) remote_.push_back(aura);
  std::vector<HandoverRequest> requests;
  for (const auto& [body, to] : requested) requests.push_back({body, to});
  return requests;
}

void AuraExchange::announce(Tick now, const MigrationDecision& decision) {
  changed_ = false;
  std::map<RegionId, std::map<BodyId, Sent>> wanted;
  for (const ProjectedAura& aura : decision.projected) {
    Sent sent;
    sent.position = quantise(WorldPosition::from(aura.box.centre));
    for (std::size_t axis = 0; axis < 3; ++axis)
      sent.half_extents[axis] = quantise_extent(aura.box.half[static_cast<Eigen::Index>(axis)]);
    sent.asleep = aura.asleep;
    for (RegionId to : aura.to) wanted[to].emplace(aura.id, sent);
  }
  std::map<RegionId, std::vector<std::uint64_t>> pulls;
  for (const Pull& pull : decision.pulls)
    for (BodyId id : pull.bodies) pulls[pull.from].push_back(id.value);

  for (auto& [id, peer] : peers_) {
    peer.frame.reset();
    if (!peer.up) continue;
    std::map<BodyId, Sent> now_projected = std::move(wanted[id]);
    std::vector<wire::Aura> changed;
    std::vector<std::uint64_t> removed;
    for (const auto& [body, sent] : now_projected) {
      const auto before = peer.projected.find(body);
      if (before != peer.projected.end() && before->second == sent) continue;
      changed.emplace_back(body.value,
                           flatbuffers::span<const std::uint8_t, 9>(sent.position.data(), 9),
                           std::uint8_t{sent.asleep},
                           flatbuffers::span<const std::uint16_t, 3>(sent.half_extents.data(), 3));
    }
    for (const auto& [body, sent] : peer.projected)
      if (!now_projected.contains(body)) removed.push_back(body.value);
    peer.projected = std::move(now_projected);
    const auto& asked = pulls[id];
    if (changed.empty() && removed.empty() && asked.empty()) continue;
    flatbuffers::FlatBufferBuilder builder(64 + changed.size() * sizeof(wire::Aura));
    const auto auras_at = builder.CreateVectorOfStructs(changed);
    const auto removed_at = builder.CreateVector(removed);
    const auto pulls_at = builder.CreateVector(asked);
    peer.frame = std::make_shared<const Bytes>(
        finish_frame(builder, wire::CreateAuras(builder, now.value, auras_at, removed_at, pulls_at),
                     FrameType::auras));
  }
}

SharedBytes AuraExchange::sign_of_life(Tick now) {
  flatbuffers::FlatBufferBuilder builder(64);
  return std::make_shared<const Bytes>(
      finish_frame(builder, wire::CreateAuras(builder, now.value), FrameType::auras));
}

SharedBytes AuraExchange::take_frame(RegionId id) {
  const auto it = peers_.find(id);
  return it == peers_.end() ? nullptr : std::exchange(it->second.frame, nullptr);
}

}  // namespace aureole
