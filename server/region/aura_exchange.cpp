// Telling and hearing auras: differences on the wire, whole sets in memory.
#include "server/region/aura_exchange.h"

#include <algorithm>
#include <cmath>

#include "protocol/wire.h"
#include "protocol/wire_values.h"
#include "server/region/handoff/handoff.h"

namespace aureole {
namespace {

/// Half extents travel in steps of 1/64 m, speeds in steps of 1/64 m/s.
constexpr double extent_step_m = 1.0 / 64;
constexpr double speed_step_mps = 1.0 / 64;
constexpr std::uint8_t asleep_flag = 1, resting_flag = 2, left_flag = 4;
/// News of resting bodies that may wait for a step; more than this is made up.
constexpr std::size_t resting_news_max = 4 * AuraExchange::max_auras;

std::uint16_t rounded_up(double value, double step) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(value / step), 0.0, 65'535.0));
}

/// Rounded up, and by the error of the quantised centre: the receiver's box holds the sender's.
std::uint16_t quantise_extent(double metres) {
  return rounded_up(metres + position_error_m, extent_step_m);
}

Result<RemoteAura> from_wire(const wire::Aura& aura, RegionId host) {
  if (!BodyId{aura.id()}.valid()) return Error{"an aura of a body that cannot be"};
  if (!(aura.mass_kg() > 0) || !std::isfinite(aura.mass_kg()))
    return Error::format("an aura of a body of {} kg", aura.mass_kg());
  QuantisedPosition position;
  for (std::size_t i = 0; i < position.size(); ++i)
    position[i] = aura.position()->Get(static_cast<flatbuffers::uoffset_t>(i));
  RemoteAura remote;
  remote.id = BodyId{aura.id()};
  remote.host = host;
  remote.asleep = (aura.flags() & asleep_flag) != 0;
  remote.resting = (aura.flags() & resting_flag) != 0;
  remote.left_its_place = (aura.flags() & left_flag) != 0;
  remote.speed_mps = aura.speed() * speed_step_mps;
  remote.mass_kg = double{aura.mass_kg()};
  remote.box.centre = dequantise(position).vector();
  for (flatbuffers::uoffset_t axis = 0; axis < 3; ++axis)
    remote.box.half[axis] = aura.half_extents()->Get(axis) * extent_step_m;
  return remote;
}

bool has_crept(const WorldPosition& from, const Eigen::Quaternionf& turned_from,
               const BodyState& to) {
  return distance(from, to.position) > AuraExchange::creep_m ||
         double{turned_from.angularDistance(to.orientation)} > AuraExchange::creep_rad;
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

Result<Tick> AuraExchange::receive(RegionId from, std::span<const std::byte> payload,
                                   std::size_t prototypes, std::size_t regions) {
  const auto* message = verified<wire::Auras>(payload);
  if (message == nullptr) return Error{"an auras message is not valid"};
  if (!is_wire_tick(message->tick()))
    return Error::format("an auras message of tick {}; expected at most {} from 0", message->tick(),
                         wire_tick_max);
  const auto too_many = [](const auto* list) {
    return list != nullptr && list->size() > max_auras;
  };
  if (too_many(message->auras()) || too_many(message->removed()) || too_many(message->pulls()) ||
      too_many(message->resting()) || too_many(message->handed_over()))
    return Error::format("more than {} auras in one message", max_auras);
  std::vector<RemoteAura> auras;
  std::vector<RestingNews> news;
  std::vector<HandoverRequest> pulls;
  Peer& peer = peers_[from];
  if (!peer.heard) news.push_back({RestingNews::Kind::told_all, from, {}});
  if (message->auras() != nullptr) {
    for (const auto* aura : *message->auras()) {
      auto remote = from_wire(*aura, from);
      if (!remote) return remote.error();
      auras.push_back(*remote);
    }
  }
  const auto take_gone = [&](const flatbuffers::Vector<std::uint64_t>* list,
                             RestingNews::Kind kind) {
    if (list == nullptr) return;
    for (std::uint64_t id : *list) news.push_back({kind, from, {BodyId{id}, {}, {}}});
  };
  take_gone(message->removed(), RestingNews::Kind::gone);
  take_gone(message->handed_over(), RestingNews::Kind::handed_over);
  if (message->resting() != nullptr) {
    for (const auto* resting : *message->resting()) {
      auto body = decode_resting(*resting, prototypes);
      if (!body) return body.error();
      news.push_back({RestingNews::Kind::rests, from, *body});
    }
  }
  if (message->pulls() != nullptr) {
    const auto* to = message->pulls_to();
    if (to == nullptr || to->size() != message->pulls()->size())
      return Error{"an auras message asks for bodies without saying where they shall go"};
    for (flatbuffers::uoffset_t i = 0; i < to->size(); ++i) {
      if (to->Get(i) >= regions)
        return Error::format("an auras message asks for a body for region {}; the world has {}",
                             to->Get(i), regions);
      pulls.push_back({BodyId{message->pulls()->Get(i)}, RegionId{to->Get(i)}});
    }
  }
  const Tick told_at{message->tick()};
  if (auras.empty() && news.empty() && pulls.empty()) return told_at;
  if (peer.theirs.size() + auras.size() > 4 * max_auras ||
      resting_news_.size() + news.size() > resting_news_max)
    return Error{"a region projects more auras than a world can hold"};

  peer.heard = true;
  for (const RestingNews& item : news)
    if (item.kind == RestingNews::Kind::gone || item.kind == RestingNews::Kind::handed_over)
      peer.theirs.erase(item.body.id);
  for (const RemoteAura& aura : auras) peer.theirs.insert_or_assign(aura.id, aura);
  resting_news_.insert(resting_news_.end(), news.begin(), news.end());
  // Only the newest message's requests are still meant: they are repeated until they are met.
  peer.pulls = std::move(pulls);
  changed_ = true;
  return told_at;
}

std::vector<HandoverRequest> AuraExchange::take_in() {
  if (!changed_) return {};
  std::map<BodyId, RegionId> requested;
  std::map<BodyId, RemoteAura> all;
  for (auto& [id, peer] : peers_) {
    for (const HandoverRequest& pull : peer.pulls) {
      const auto [at, fresh] = requested.try_emplace(pull.body, pull.to);
      if (!fresh) at->second = std::min(at->second, pull.to);
    }
    peer.pulls.clear();
    for (const auto& [body, aura] : peer.theirs) all.try_emplace(body, aura);
  }
  remote_.clear();
  for (const auto& [body, aura] : all) remote_.push_back(aura);
  std::vector<HandoverRequest> requests;
  for (const auto& [body, to] : requested) requests.push_back({body, to});
  return requests;
}

bool AuraExchange::has_heard(RegionId id) const {
  const auto it = peers_.find(id);
  return it != peers_.end() && it->second.heard;
}

std::vector<RestingNews> AuraExchange::take_resting_news() {
  return std::exchange(resting_news_, {});
}

SharedBytes AuraExchange::frame_for(Peer& peer, std::map<BodyId, Sent>&& wanted,
                                    const std::vector<HandoverRequest>& pulls, Tick now,
                                    const AuraBodies& bodies) const {
  std::vector<wire::Aura> auras;
  std::vector<wire::Resting> resting;
  std::vector<std::uint64_t> removed, handed_over;
  std::map<BodyId, Projection> projected;
  for (auto& [body, sent] : wanted) {
    const auto before = peer.projected.find(body);
    const bool known = before != peer.projected.end();
    Projection& projection = projected[body];
    if (known) projection = before->second;
    if ((sent.flags & resting_flag) != 0) {
      const NewBody exact = bodies.resting_body(body);
      const bool told = known && (before->second.sent.flags & resting_flag) != 0;
      if (!projection.rested || !told ||
          has_crept(projection.position, projection.orientation, exact.state)) {
        resting.push_back(encode_resting(exact));
        projection.position = exact.state.position;
        projection.orientation = exact.state.orientation;
        projection.rested = true;
      }
    } else if (projection.rested &&
               distance(projection.position, bodies.resting_body(body).state.position) > left_m) {
      sent.flags |= left_flag;
    }
    if (known && before->second.sent == sent) continue;
    projection.sent = sent;
    auras.emplace_back(
        body.value, static_cast<float>(bodies.mass_kg(body)),
        flatbuffers::span<const std::uint8_t, 9>(sent.position.data(), 9), sent.flags,
        flatbuffers::span<const std::uint16_t, 3>(sent.half_extents.data(), 3), sent.speed);
  }
  for (const auto& [body, projection] : peer.projected)
    if (!wanted.contains(body))
      (bodies.was_handed_over(body) ? handed_over : removed).push_back(body.value);
  peer.projected = std::move(projected);
  if (peer.greeted && auras.empty() && resting.empty() && removed.empty() && handed_over.empty() &&
      pulls.empty())
    return nullptr;
  peer.greeted = true;
  flatbuffers::FlatBufferBuilder builder(64 + auras.size() * sizeof(wire::Aura) +
                                         resting.size() * sizeof(wire::Resting));
  const auto auras_at = builder.CreateVectorOfStructs(auras);
  const auto resting_at = builder.CreateVectorOfStructs(resting);
  const auto removed_at = builder.CreateVector(removed);
  const auto handed_over_at = builder.CreateVector(handed_over);
  std::vector<std::uint64_t> asked;
  std::vector<std::uint16_t> asked_to;
  for (const HandoverRequest& pull : pulls) {
    asked.push_back(pull.body.value);
    asked_to.push_back(pull.to.value);
  }
  const auto pulls_at = builder.CreateVector(asked);
  const auto pulls_to_at = builder.CreateVector(asked_to);
  return std::make_shared<const Bytes>(
      finish_frame(builder,
                   wire::CreateAuras(builder, now.value, auras_at, resting_at, removed_at,
                                     handed_over_at, pulls_at, pulls_to_at),
                   FrameType::auras));
}

void AuraExchange::announce(Tick now, const MigrationDecision& decision, const AuraBodies& bodies) {
  changed_ = false;
  std::map<RegionId, std::map<BodyId, Sent>> wanted;
  for (const ProjectedAura& aura : decision.projected) {
    Sent sent;
    sent.position = quantise(WorldPosition::from(aura.box.centre));
    for (std::size_t axis = 0; axis < 3; ++axis)
      sent.half_extents[axis] = quantise_extent(aura.box.half[static_cast<Eigen::Index>(axis)]);
    sent.flags = static_cast<std::uint8_t>((aura.asleep ? asleep_flag : 0) |
                                           (aura.resting ? resting_flag : 0));
    sent.speed = rounded_up(aura.speed_mps, speed_step_mps);
    for (RegionId to : aura.to) wanted[to].emplace(aura.id, sent);
  }
  std::map<RegionId, std::vector<HandoverRequest>> pulls;
  for (const Pull& pull : decision.pulls)
    for (BodyId id : pull.bodies) pulls[pull.from].push_back({id, pull.to});
  for (auto& [id, peer] : peers_) {
    peer.frame.reset();
    if (peer.up) peer.frame = frame_for(peer, std::move(wanted[id]), pulls[id], now, bodies);
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
