// A store's bodies, removals and players as answers to a region that recovers.
#include "server/replica/recovery_answer.h"

#include <algorithm>

#include "protocol/wire.h"
#include "protocol/wire_values.h"

namespace aureole {
namespace {

constexpr std::size_t states_per_frame = 32'768;
constexpr std::size_t removals_per_frame = 65'536;
/// Poses on the grid tell a speed to 3 cm/s over this many ticks.
constexpr std::int64_t speed_ticks = 2;

wire::ReplicaVersion to_wire(const Version& v) {
  return {v.epoch, v.region.value, v.incarnation.value};
}

wire::ReplicaKey make_key(BodyId id, const ReplicaStore::KeyState& key) {
  const BodyState& s = key.state;
  return {id.value,
          to_wire(key.version),
          0,
          key.prototype.value,
          static_cast<std::uint8_t>(s.activation),
          aureole::to_wire(s.position),
          aureole::to_wire(s.orientation),
          aureole::to_wire(s.linear_velocity),
          aureole::to_wire(s.angular_velocity),
          s.deactivation_time_s};
}

template <class T>
std::span<const T> piece(const std::vector<T>& all, std::size_t n, std::size_t size) {
  const std::size_t from = std::min(n * size, all.size());
  return std::span(all).subspan(from, std::min(size, all.size() - from));
}

std::size_t pieces(std::size_t count, std::size_t size) {
  return (count + size - 1) / size;
}

}  // namespace

std::vector<std::pair<BodyId, ReplicaStore::KeyState>> ReplicaStore::newest_states() const {
  std::vector<std::pair<BodyId, KeyState>> all;
  all.reserve(order_.size());
  for (const Place& place : order_) {
    const Body& body = bodies_[place.body];
    auto& [id, key] = all.emplace_back(body.id, body.key);
    const Tick newest = body.history.newest_tick();
    if (newest <= key.tick) continue;
    WorldPosition before;
    Eigen::Quaternionf orientation_before;
    body.history.at((newest - speed_ticks).value * tick_us, before, orientation_before);
    body.history.at(newest.value * tick_us, key.state.position, key.state.orientation);
    key.state.orientation.normalize();
    key.state.linear_velocity =
        key.state.position.relative_to(before) / (static_cast<float>(speed_ticks) * tick_s);
    key.state.activation = Activation::awake;
    key.state.deactivation_time_s = 0;
    key.tick = newest;
  }
  return all;
}

std::vector<ReplicaPlayer> ReplicaStore::players() const {
  std::vector<ReplicaPlayer> all;
  for (const auto& [id, player] : players_) all.push_back(player);
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.player < b.player; });
  return all;
}

std::optional<Tick> ReplicaStore::last_heard(RegionId from) const {
  const auto region = regions_.find(from);
  return region == regions_.end() ? std::nullopt : region->second.heard;
}

Result<std::vector<SharedBytes>> answer_recovery(const ReplicaStore& store, RegionId asks,
                                                 std::span<const std::byte> query) {
  const auto* question = verified<wire::RecoveryQuery>(query);
  if (question == nullptr || question->round() == 0)
    return Error{"a recovery query is not a valid message"};

  std::vector<wire::ReplicaKey> states;
  for (const auto& [id, key] : store.newest_states()) states.push_back(make_key(id, key));
  std::vector<wire::RecoveryTrace> removals;
  for (const auto& [id, version] : store.tombstones().all())
    removals.push_back({id.value, to_wire(version), true});
  std::vector<wire::PlayerStatus> players;
  for (const ReplicaPlayer& p : store.players())
    players.push_back(
        {p.player.value, p.session, p.applied_sequence, p.connected, p.carried.value});

  const std::size_t count = std::max({std::size_t{1}, pieces(states.size(), states_per_frame),
                                      pieces(removals.size(), removals_per_frame)});
  const std::int64_t heard = store.last_heard(asks).value_or(Tick{-1}).value;
  std::vector<SharedBytes> frames;
  for (std::size_t n = 0; n < count; ++n) {
    const auto some_states = piece(states, n, states_per_frame);
    const auto some_removals = piece(removals, n, removals_per_frame);
    const auto some_players = n == 0 ? std::span(players) : std::span<wire::PlayerStatus>();
    flatbuffers::FlatBufferBuilder builder(256 + some_states.size_bytes() +
                                           some_removals.size_bytes() + some_players.size_bytes());
    const auto traces_at =
        builder.CreateVectorOfStructs(some_removals.data(), some_removals.size());
    const auto states_at = builder.CreateVectorOfStructs(some_states.data(), some_states.size());
    const auto players_at =
        builder.CreateVectorOfStructs(some_players.data(), some_players.size());
    frames.push_back(std::make_shared<const Bytes>(
        finish_frame(builder,
                     wire::CreateRecoveryAnswer(builder, question->round(), n + 1 == count, false,
                                                heard, traces_at, states_at, players_at),
                     FrameType::recovery_answer)));
  }
  return frames;
}

}  // namespace aureole
