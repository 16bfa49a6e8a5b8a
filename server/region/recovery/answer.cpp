// Questions and answers of a recovery to frames and back.
#include "server/region/recovery/answer.h"

#include <algorithm>

#include "protocol/wire.h"
#include "protocol/wire_values.h"
#include "server/region/handoff/handoff.h"

namespace aureole {
namespace {

using aureole::from_wire;
using aureole::to_wire;

constexpr std::size_t traces_per_frame = 65'536;
constexpr std::size_t states_per_frame = 32'768;

wire::ReplicaVersion to_wire(const Version& v) {
  return {v.epoch, v.region.value, v.incarnation.value};
}

Version from_wire(const wire::ReplicaVersion& v) {
  return {v.epoch(), Incarnation{v.incarnation()}, RegionId{v.region()}};
}

wire::ReplicaKey to_wire(const KnownState& known) {
  const BodyState& s = known.body.state;
  return {known.body.id.value,
          to_wire(known.version),
          0,
          known.body.prototype.value,
          static_cast<std::uint8_t>(s.activation),
          to_wire(s.position),
          to_wire(s.orientation),
          to_wire(s.linear_velocity),
          to_wire(s.angular_velocity),
          s.deactivation_time_s};
}

Status check_version(BodyId id, const wire::ReplicaVersion& version, std::size_t regions) {
  if (!id.valid())
    return Error::format("a recovery answer names body {:#x}, which cannot be", id.value);
  if (version.region() >= regions)
    return Error::format("a recovery answer has body {:#x} in region {}; this world has {}",
                         id.value, version.region(), regions);
  return Ok{};
}

Result<KnownState> from_wire(const wire::ReplicaKey& key, std::size_t regions,
                             std::size_t prototypes) {
  const BodyId id{key.id()};
  if (auto ok = check_version(id, key.version(), regions); !ok) return ok.error();
  if (key.prototype() >= prototypes)
    return Error::format("a recovery answer has body {:#x} of prototype {}; this world has {}",
                         id.value, key.prototype(), prototypes);
  if (key.activation() > static_cast<std::uint8_t>(Activation::asleep))
    return Error::format("a recovery answer has body {:#x} in activation {}; expected 0 to 2",
                         id.value, key.activation());
  const BodyState state{from_wire(key.position()),
                        from_wire(key.orientation()),
                        from_wire(key.linear_velocity()),
                        from_wire(key.angular_velocity()),
                        static_cast<Activation>(key.activation()),
                        key.deactivation_time_s()};
  if (!may_travel(state))
    return Error::format(
        "a recovery answer has body {:#x} with numbers that are not finite, out of range or no "
        "rotation",
        id.value);
  return KnownState{{id, PrototypeId{key.prototype()}, state}, from_wire(key.version())};
}

Result<KnownPlayer> from_wire(const wire::PlayerStatus& p) {
  const BodyId carried{p.carried()};
  const bool can_be =
      carried == BodyId{} || (carried.valid() && carried.kind() != BodyId::Kind::avatar);
  if (p.player() == 0 || p.session() > session_max || !can_be)
    return Error::format("a recovery answer has player {} in session {} carrying {:#x}", p.player(),
                         p.session(), p.carried());
  return KnownPlayer{PlayerId{p.player()}, p.session(), p.applied_sequence(), carried};
}

template <class T>
std::span<const T> piece(const std::vector<T>& all, std::size_t n, std::size_t size) {
  const std::size_t from = std::min(n * size, all.size());
  return std::span(all).subspan(from, std::min(size, all.size() - from));
}

}  // namespace

SharedBytes encode_recovery_query(std::uint64_t round) {
  flatbuffers::FlatBufferBuilder builder(64);
  return std::make_shared<const Bytes>(
      finish_frame(builder, wire::CreateRecoveryQuery(builder, round), FrameType::recovery_query));
}

Result<std::uint64_t> decode_recovery_query(std::span<const std::byte> payload) {
  const auto* query = verified<wire::RecoveryQuery>(payload);
  if (query == nullptr || query->round() == 0) return Error{"a recovery query is not valid"};
  return query->round();
}

std::vector<SharedBytes> encode_recovery_answer(const RecoveryAnswer& answer) {
  std::vector<SharedBytes> frames;
  const std::size_t count = std::max<std::size_t>(
      1, std::max((answer.traces.size() + traces_per_frame - 1) / traces_per_frame,
                  (answer.states.size() + states_per_frame - 1) / states_per_frame));
  for (std::size_t n = 0; n < count; ++n) {
    std::vector<wire::RecoveryTrace> traces;
    for (const Trace& t : piece(answer.traces, n, traces_per_frame))
      traces.push_back({t.id.value, to_wire(t.version), t.removed});
    std::vector<wire::ReplicaKey> states;
    for (const KnownState& s : piece(answer.states, n, states_per_frame))
      states.push_back(to_wire(s));
    std::vector<wire::PlayerStatus> players;
    if (n == 0)
      for (const KnownPlayer& p : answer.players)
        players.push_back({p.player.value, p.session, p.applied_sequence, false, p.carried.value});
    flatbuffers::FlatBufferBuilder builder(256 + traces.size() * sizeof(wire::RecoveryTrace) +
                                           states.size() * sizeof(wire::ReplicaKey));
    const auto traces_at = builder.CreateVectorOfStructs(traces);
    const auto states_at = builder.CreateVectorOfStructs(states);
    const auto players_at = builder.CreateVectorOfStructs(players);
    frames.push_back(std::make_shared<const Bytes>(finish_frame(
        builder,
        wire::CreateRecoveryAnswer(builder, answer.round, answer.complete && n + 1 == count,
                                   answer.recovering, answer.heard.value, traces_at, states_at,
                                   players_at),
        FrameType::recovery_answer)));
  }
  return frames;
}

Result<RecoveryAnswer> decode_recovery_answer(std::span<const std::byte> payload,
                                              std::size_t regions, std::size_t prototypes) {
  const auto* message = verified<wire::RecoveryAnswer>(payload);
  if (message == nullptr) return Error{"a recovery answer is not a valid message"};
  if (message->heard_tick() < -1 || message->heard_tick() > wire_tick_max)
    return Error::format("a recovery answer has heard of tick {}", message->heard_tick());
  RecoveryAnswer answer{message->round(),
                        message->complete(),
                        message->recovering(),
                        Tick{message->heard_tick()},
                        {},
                        {},
                        {}};
  if (message->traces() != nullptr) {
    for (const wire::RecoveryTrace* t : *message->traces()) {
      if (auto ok = check_version(BodyId{t->id()}, t->version(), regions); !ok) return ok.error();
      answer.traces.push_back({BodyId{t->id()}, from_wire(t->version()), t->removed()});
    }
  }
  if (message->states() != nullptr) {
    for (const wire::ReplicaKey* key : *message->states()) {
      auto state = from_wire(*key, regions, prototypes);
      if (!state) return state.error();
      answer.states.push_back(*state);
    }
  }
  if (message->players() != nullptr) {
    for (const wire::PlayerStatus* p : *message->players()) {
      auto player = from_wire(*p);
      if (!player) return player.error();
      answer.players.push_back(*player);
    }
  }
  return answer;
}

}  // namespace aureole
