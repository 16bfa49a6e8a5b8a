// Telling auras: what a peer does not know yet, or knows otherwise.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/base/merge_in.h"
#include "server/base/prefetch.h"
#include "server/region/auras/aura_exchange.h"
#include "server/region/auras/aura_wire.h"
#include "server/region/handoff/handoff.h"

namespace aureole {
namespace {

using namespace aura_wire;

std::uint16_t rounded_up(double value, double step) {
  // The same as std::ceil, without its call.
  const double steps = std::clamp(value / step, 0.0, 65'535.0);
  const auto whole = static_cast<std::uint16_t>(steps);
  return static_cast<std::uint16_t>(whole + (whole < steps ? 1 : 0));
}

struct RoundedSpine {
  std::array<std::int8_t, 3> steps{};
  double error_m = 0;  ///< Between an end as it is and as it is told.
};

RoundedSpine round_spine(const Eigen::Vector3d& half_spine) {
  RoundedSpine rounded;
  std::array<double, 3> errors{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double exact = half_spine[static_cast<Eigen::Index>(axis)];
    const double steps = std::clamp(exact / spine_step_m, -127.0, 127.0);
    // The same as std::round, without its call.
    const auto whole = static_cast<std::int8_t>(steps + (steps < 0 ? -0.5 : 0.5));
    rounded.steps[axis] = whole;
    errors[axis] = exact - whole * spine_step_m;
  }
  const auto [x, y, z] = errors;
  rounded.error_m = std::sqrt(x * x + (y * y + z * z));
  return rounded;
}

bool has_crept(const WorldPosition& from, const Eigen::Quaternionf& turned_from,
               const BodyState& to) {
  return distance(from, to.position) > AuraExchange::creep_m ||
         double{turned_from.angularDistance(to.orientation)} > AuraExchange::creep_rad;
}

}  // namespace

std::uint16_t AuraExchange::take_slot(Peer& peer) {
  if (peer.free_slots.empty()) return peer.next_slot == no_slot ? no_slot : peer.next_slot++;
  const std::uint16_t slot = peer.free_slots.back();
  peer.free_slots.pop_back();
  return slot;
}

/// Brings one projection to what is wanted; `known`: the peer has heard of it.
void AuraExchange::tell(Peer& peer, const Wanted& wanted, Projection& projection, bool known,
                        const AuraBodies& bodies, Message& message) {
  Sent sent = wanted.sent;
  const std::uint8_t before = known ? projection.sent.flags : std::uint8_t{0};
  constexpr std::uint8_t sleeps = asleep_flag | resting_flag;
  if ((sent.flags & resting_flag) != 0) {
    const bool told = (before & resting_flag) != 0 && projection.rested;
    // What slept and sleeps lies where it lay.
    const bool lies = told && (before & sleeps) == sleeps && (sent.flags & sleeps) == sleeps;
    if (!lies) {
      const NewBody exact = bodies.resting_body(wanted.id);
      if (!told || has_crept(projection.position, projection.orientation, exact.state)) {
        message.resting.push_back(encode_resting(exact));
        projection.position = exact.state.position;
        projection.orientation = exact.state.orientation;
        projection.rested = true;
      }
    }
  } else if (projection.rested &&
             distance(projection.position, bodies.resting_body(wanted.id).state.position) >
                 left_m) {
    sent.flags |= left_flag;
  }
  if (known && projection.sent == sent) return;
  projection.sent = sent;
  const flatbuffers::span<const std::uint8_t, 9> position(sent.position.data(), 9);
  const flatbuffers::span<const std::int8_t, 3> half_spine(sent.half_spine.data(), 3);
  if (known && projection.slot != no_slot) {
    message.moved.emplace_back(projection.slot, sent.speed, sent.girth, sent.cluster, position,
                               half_spine, sent.flags, sent.company);
    return;
  }
  if (!known) projection.slot = take_slot(peer);
  message.auras.emplace_back(wanted.id.value, static_cast<float>(bodies.mass_kg(wanted.id)),
                             projection.slot, sent.speed, sent.girth, sent.cluster, position,
                             half_spine, sent.flags, sent.company);
}

SharedBytes AuraExchange::frame_for(Peer& peer, const std::vector<HandoverRequest>& pulls, Tick now,
                                    const AuraBodies& bodies) {
  Message& message = message_;
  message.clear();
  // In their places: most of what a peer knows it is to know now as well.
  std::vector<Projection>& projected = peer.projected;
  std::vector<Projection>& fresh = peer.projected_anew;
  fresh.clear();
  std::size_t before = 0, kept = 0;
  const auto withdraw = [&](const Projection& gone) {
    (bodies.was_handed_over(gone.id) ? message.handed_over : message.removed)
        .push_back(gone.id.value);
    if (gone.slot != no_slot) peer.free_slots.push_back(gone.slot);
  };
  for (const Wanted& wanted : peer.wanted) {
    while (before < projected.size() && projected[before].id < wanted.id)
      withdraw(projected[before++]);
    if (before < projected.size() && projected[before].id == wanted.id) {
      if (kept != before) projected[kept] = projected[before];
      ++before;
      tell(peer, wanted, projected[kept++], true, bodies, message);
    } else {
      fresh.emplace_back().id = wanted.id;
      tell(peer, wanted, fresh.back(), false, bodies, message);
    }
  }
  while (before < projected.size()) withdraw(projected[before++]);
  const auto middle = static_cast<std::ptrdiff_t>(kept);
  projected.erase(projected.begin() + middle, projected.end());
  projected.insert(projected.end(), fresh.begin(), fresh.end());
  merge_in(projected, middle, [](const Projection& a, const Projection& b) { return a.id < b.id; });
  if (peer.greeted && message.empty() && pulls.empty()) return nullptr;
  peer.greeted = true;

  std::vector<std::uint64_t> asked;
  std::vector<std::uint16_t> asked_to;
  std::vector<std::uint8_t> asked_known;
  for (const HandoverRequest& pull : pulls) {
    asked.push_back(pull.body.value);
    asked_to.push_back(pull.to.value);
    asked_known.push_back(static_cast<std::uint8_t>(pull.known));
  }
  flatbuffers::FlatBufferBuilder& builder = builder_;
  builder.Clear();
  // Empty lists are left out: few bytes, but in every message to every neighbour.
  const auto structs = [&](const auto& list) {
    using Offset = decltype(builder.CreateVectorOfStructs(list));
    return list.empty() ? Offset{} : builder.CreateVectorOfStructs(list);
  };
  const auto numbers = [&](const auto& list) {
    using Offset = decltype(builder.CreateVector(list));
    return list.empty() ? Offset{} : builder.CreateVector(list);
  };
  const auto auras_at = structs(message.auras);
  const auto moved_at = structs(message.moved);
  const auto resting_at = structs(message.resting);
  const auto removed_at = numbers(message.removed);
  const auto handed_over_at = numbers(message.handed_over);
  const auto pulls_at = numbers(asked);
  const auto pulls_to_at = numbers(asked_to);
  const auto pulls_known_at = numbers(asked_known);
  return frames_.finish(builder,
                        wire::CreateAuras(builder, now.value, auras_at, resting_at, removed_at,
                                          handed_over_at, pulls_at, pulls_to_at, moved_at,
                                          pulls_known_at),
                        FrameType::auras);
}

AuraExchange::Sent AuraExchange::as_sent(const ProjectedAura& aura) {
  Sent sent;
  sent.position = quantise(WorldPosition::from(aura.room.centre));
  const RoundedSpine spine = round_spine(aura.room.half_spine);
  sent.half_spine = spine.steps;
  // The receiver's room holds the sender's.
  sent.girth =
      rounded_up(aura.room.girth_m + spine.error_m + std::sqrt(3) * position_error_m, girth_step_m);
  sent.cluster = aura.company.label;
  sent.company = static_cast<std::uint8_t>(
      aura.company.size_class | aura.company.changes << changes_shift |
      (aura.company.crowded ? crowded_flag : 0) | (aura.company.lately ? lately_flag : 0));
  sent.flags = static_cast<std::uint8_t>((aura.asleep ? asleep_flag : 0) |
                                         (aura.resting ? resting_flag : 0));
  sent.speed = rounded_up(aura.speed_mps, speed_step_mps);
  return sent;
}

void AuraExchange::announce(Tick now, const MigrationDecision& decision, const AuraBodies& bodies) {
  changed_ = false;
  std::array<Peer*, RegionSet::capacity> listening{};
  for (auto& [id, peer] : peers_) {
    peer.frame.reset();
    peer.wanted.clear();
    prefetch_beginning(peer.projected);
    if (peer.up && id.value < listening.size()) listening[id.value] = &peer;
  }
  sent_.clear();
  for (const ProjectedAura& aura : decision.projected) sent_.push_back(as_sent(aura));
  // Not each as soon as it is written: a processor cannot read at once what was written bit by bit
  // just now.
  for (std::size_t n = 0; n < sent_.size(); ++n) {
    const ProjectedAura& aura = decision.projected[n];
    aura.to.for_each([&](RegionId to) {
      Peer* const peer = listening[to.value];
      if (peer == nullptr) return;
      std::vector<Wanted>& wanted = peer->wanted;
      AUREOLE_CHECK(wanted.empty() || wanted.back().id < aura.id,
                    "a policy names each aura once, in ascending order");
      Wanted& added = wanted.emplace_back();
      added.id = aura.id;
      added.sent = sent_[n];
    });
  }
  std::map<RegionId, std::vector<HandoverRequest>> pulls;
  for (const Pull& pull : decision.pulls)
    for (BodyId id : pull.bodies) pulls[pull.from].push_back({id, pull.to, {}, pull.known});
  static const std::vector<HandoverRequest> none;
  for (auto& [id, peer] : peers_) {
    if (!peer.up) continue;
    const auto asked = pulls.find(id);
    // Most peers of a large world are far away.
    const bool silent =
        peer.greeted && peer.wanted.empty() && peer.projected.empty() && asked == pulls.end();
    if (!silent)
      peer.frame = frame_for(peer, asked == pulls.end() ? none : asked->second, now, bodies);
  }
}

SharedBytes AuraExchange::sign_of_life(Tick now) {
  builder_.Clear();
  return frames_.finish(builder_, wire::CreateAuras(builder_, now.value), FrameType::auras);
}

SharedBytes AuraExchange::take_frame(RegionId id) {
  const auto it = peers_.find(id);
  return it == peers_.end() ? nullptr : std::exchange(it->second.frame, nullptr);
}

}  // namespace aureole
