// What scripted players want next, and the road of their commands to the avatar's owner.
#include "server/experiment/simulated/simulated_players.h"

#include <cmath>

#include "server/region/handoff/handoff.h"

namespace aureole {
namespace {

/// Avatars reach this far (m).
constexpr double reach_m = 4;

PlayerCommand from_wire(const wire::Command& c) {
  PlayerCommand command;
  command.player = PlayerId{c.player()};
  command.session = c.session();
  command.sequence = c.sequence();
  command.kind = static_cast<PlayerCommand::Kind>(c.kind());
  command.keys = c.keys();
  command.item = c.item();
  command.gateway = c.gateway();
  command.target = BodyId{c.target()};
  command.yaw = c.yaw();
  command.pitch = c.pitch();
  command.spawn = c.spawn();
  return command;
}

}  // namespace

SimulatedPlayers::SimulatedPlayers(const WorldDefinition& world, int count, std::uint64_t seed)
    : world_(world) {
  for (int n = 0; n < count; ++n) {
    const PlayerId id{static_cast<std::uint32_t>(n + 1)};
    const auto spawn = static_cast<std::uint16_t>(n);
    CommandStreamOptions options{id, 0, 1, spawn};
    players_.push_back({id, spawn, CommandStream(options), Random(seed, 200 + id.value)});
    players_.back().joins_at_us = 300'000 * (n + 1);
  }
}

void SimulatedPlayers::wake(SimulatedNetwork& network, SimulatedGateway& gateway, Micros now,
                            bool active) {
  wakes_at_us_ = now + interval_us;
  if (!gateway.runs()) return;
  for (Player& player : players_) {
    if (now < player.joins_at_us) continue;
    if (player.gateway != gateway.incarnation() ||
        player.stream.must_restart(now)) {  // The browser is connected anew.
      if (player.gateway != Incarnation{}) player.stream.restart(++player.session);
      player.gateway = gateway.incarnation();
    }
    const ReplicaStore& store = gateway.store();
    const auto told = store.player(player.id);
    if (told)
      if (const auto tick = store.newest_tick(told->owner))
        player.stream.confirm(told->session, told->applied_sequence, *tick, now);
    decide(player, gateway, now, active);
    deliver(player, network, gateway, now);
  }
}

BodyId SimulatedPlayers::something_near(const Player& player, const ReplicaStore& store,
                                        Micros now) const {
  std::vector<ReplicaPose> poses;
  store.sample(now, poses);
  const auto self = store.sample_body(BodyId::avatar(player.id), now);
  if (!self) return {};
  BodyId best;
  double nearest = reach_m;
  for (const ReplicaPose& pose : poses) {
    if (pose.id.kind() == BodyId::Kind::avatar) continue;
    const double away = distance(pose.position, self->position);
    if (away >= nearest) continue;
    nearest = away;
    best = pose.id;
  }
  return best;
}

void SimulatedPlayers::decide(Player& player, const SimulatedGateway& gateway, Micros now,
                              bool active) {
  CommandIntent intent;
  Random& random = player.random;
  if (!active) {
    if (player.keys == 0) return;
    player.keys = 0;
    intent.yaw = player.yaw;
    static_cast<void>(player.stream.push(intent));
    return;
  }
  if (now >= player.next_turn_us) {
    // To and fro: mostly back towards where it started, which is beside a boundary.
    player.next_turn_us = now + 400'000 + random.below(1'500'000);
    const auto self = gateway.store().sample_body(BodyId::avatar(player.id), now);
    const WorldPosition home = world_.spawn_points[player.spawn].position;
    if (self && distance(self->position, home) > 9)
      player.yaw = static_cast<float>(
          std::atan2(-(home.x - self->position.x), -(home.z - self->position.z)));
    else
      player.yaw = static_cast<float>(random.between(-M_PI, M_PI));
    player.keys = random.chance(0.8) ? keys::forward : std::uint8_t{0};
    if (random.chance(0.3)) player.keys |= keys::sprint;
    if (random.chance(0.15)) player.keys |= keys::jump;
  }
  intent.keys = player.keys;
  intent.yaw = player.yaw;
  intent.pitch = -0.1f;
  static_cast<void>(player.stream.push(intent));
  if (now < player.next_deed_us) return;
  player.next_deed_us = now + 300'000 + random.below(1'500'000);
  const double what = random.unit();
  intent.kind = what < 0.45  ? wire::CommandKind::throw_body
                : what < 0.6 ? wire::CommandKind::blast
                             : wire::CommandKind::grab;
  if (intent.kind == wire::CommandKind::grab)
    intent.target = something_near(player, gateway.store(), now);
  if (player.stream.push(intent)) last_deed_us_ = now;
}

void SimulatedPlayers::deliver(Player& player, SimulatedNetwork& network, SimulatedGateway& gateway,
                               Micros now) {
  const ReplicaStore& store = gateway.store();
  const auto version = store.version(BodyId::avatar(player.id));
  // A store that has not heard of everybody cannot say that an avatar does not exist.
  for (std::size_t i = 0; i < world_.regions.size(); ++i)
    if (!version && !store.is_complete(RegionId{static_cast<std::uint16_t>(i)})) return;
  player.stream.set_avatar_exists(version.has_value());
  const WorldPosition& spawn = world_.spawn_points[player.spawn].position;
  const RegionId owner = version ? version->region : region_at(world_.regions, spawn.x, spawn.z);
  std::vector<PlayerCommand> commands;
  for (const wire::Command& c : player.stream.due(owner, now)) commands.push_back(from_wire(c));
  if (commands.empty()) return;
  const Bytes frame = encode_frame(FrameType::commands, 0, encode_commands(commands));
  gateway.send(network, owner, std::make_shared<const Bytes>(frame), now);
}

}  // namespace aureole
