// Players' commands in order, and what they do: walk, throw, grab, blast, respawn, come and go.
#include "server/region/players/players.h"

#include <algorithm>
#include <cmath>

#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {
namespace {

/// Long and light things are held in their middle rather than refused by the next region.
constexpr float carried_distance_max_m = 50;

}  // namespace

Players::Players(const WorldDefinition& world, const PartitionMap& map, RegionId self,
                 Hosting& hosting)
    : world_(world),
      map_(map),
      self_(self),
      hosting_(hosting),
      half_height_(avatar_half_height(world.prototypes[world.avatar.value].body)),
      // What players do is sudden: it takes effect ahead, at the same tick on all servers.
      blast_lead_ticks_(blast_lead_ticks(world.tolerances)),
      wind_up_ticks_(std::llround(reach_time_s(world.tolerances) / tick_s)),
      hold_ticks_(round_trip_ticks(world.tolerances) + wind_up_ticks_) {}

WorldPosition Players::eye(const Avatar& avatar) const {
  WorldPosition position = hosting_.physics().position(avatar.body());
  position.y += half_height_ - tuning_.eye_below_top_m;
  return position;
}

BodyState Players::standing_at(std::uint16_t spawn, PlayerId player) const {
  const SpawnPoint& point = world_.spawn_points[spawn % world_.spawn_points.size()];
  BodyState state;
  state.position = point.position;
  // Players who share a spawn point stand around it rather than in each other.
  const double angle = player.value % 8 * (2 * M_PI / 8);
  state.position.x += 0.9 * std::cos(angle);
  state.position.z += 0.9 * std::sin(angle);
  return state;
}

void Players::command(const PlayerCommand& command, Tick now, bool room, PlayerOutput& out) {
  const auto it = avatars_.find(command.player);
  if (it == avatars_.end()) {
    const auto moved = moved_.find(command.player);
    // A gateway that asks for a new avatar in a later session knows that the one of before is gone.
    const bool anew = command.kind == PlayerCommand::Kind::join && command.target == BodyId{} &&
                      (moved == moved_.end() || command.session > moved->second.session);
    if (anew)
      join(command, now, room, out);
    else if (moved != moved_.end())
      out.forwarded[moved->second.to].push_back(command);
    return;  // For an avatar that is elsewhere the gateway will ask again.
  }
  Avatar& avatar = it->second;
  if (command.kind == PlayerCommand::Kind::join && command.session > avatar.session) {
    avatar.session = command.session;
    avatar.applied_sequence = command.sequence;
    avatar.gateway = command.gateway;
    avatar.connected = true;
    avatar.keys = 0;
    avatar.waiting.clear();
    avatar.active = now;
    return;
  }
  if (command.session != avatar.session || command.sequence <= avatar.applied_sequence) return;
  // Those from too far ahead would take the places of those whose turn comes first.
  if (command.sequence - avatar.applied_sequence <= Avatar::max_waiting)
    avatar.waiting.emplace(command.sequence, command);
  // Nobody was prepared for one who has stood idle to do anything: now its aura grows first.
  if (!in_play(avatar, now) && avatar.company) avatar.held_until = now + wind_up_ticks_;
  avatar.active = now;
  apply_waiting(command.player, now, room, out);
}

bool Players::in_play(const Avatar& avatar, Tick now) const {
  return avatar.connected && (avatar.keys != 0 || now - avatar.active <= idle_ticks);
}

void Players::note_company(PlayerId player, bool company) {
  avatars_.at(player).company = company;
}

void Players::join(const PlayerCommand& command, Tick now, bool room, PlayerOutput& out) {
  const BodyState state = standing_at(command.spawn, command.player);
  const RegionId home = map_.region_at(state.position.x, state.position.z);
  if (home != self_) {
    out.forwarded[home].push_back(command);
    return;
  }
  if (!room) return;
  Avatar avatar;
  avatar.player = command.player;
  avatar.session = command.session;
  avatar.applied_sequence = command.sequence;
  avatar.gateway = command.gateway;
  avatar.active = now;
  avatar.yaw = world_.spawn_points[command.spawn % world_.spawn_points.size()].yaw_rad;
  const NewBody body{avatar.body(), world_.avatar, state};
  // Sessions grow four times a second for ever, owners change far less often.
  hosting_.spawn(std::span(&body, 1), command.session);
  avatars_.emplace(command.player, std::move(avatar));
  moved_.erase(command.player);
}

void Players::apply_waiting(PlayerId player, Tick now, bool room, PlayerOutput& out) {
  while (true) {
    const auto it = avatars_.find(player);
    if (it == avatars_.end()) return;  // It left.
    Avatar& avatar = it->second;
    if (now < std::max(avatar.held_until, held_until_)) return;
    const auto next = avatar.waiting.find(avatar.applied_sequence + 1);
    if (next == avatar.waiting.end()) return;
    const PlayerCommand command = next->second;
    avatar.waiting.erase(next);
    avatar.applied_sequence = command.sequence;
    apply(avatar, command, now, room, out);
  }
}

void Players::apply(Avatar& avatar, const PlayerCommand& command, Tick now, bool room,
                    PlayerOutput& out) {
  using Kind = PlayerCommand::Kind;
  if (command.kind == Kind::lost) {
    avatar.connected = false;
    avatar.lost_since = now;
    return;
  }
  avatar.connected = true;
  avatar.yaw = command.yaw;
  avatar.pitch = command.pitch;
  switch (command.kind) {
    case Kind::input:
      avatar.keys = command.keys;
      break;
    case Kind::throw_body:
      throw_body(avatar, command, room, out);
      break;
    case Kind::grab:
      grab(avatar, command.target, now, out);
      break;
    case Kind::blast:
      blast(avatar, command, now, out);
      break;
    case Kind::respawn:
      respawn(avatar.player, command.spawn);
      break;
    case Kind::leave:
      remove_avatar(avatar.player, out);
      break;
    case Kind::join:
    case Kind::lost:
      break;  // Handled above.
  }
}

void Players::throw_body(Avatar& avatar, const PlayerCommand& command, bool room,
                         PlayerOutput& out) {
  PhysicsWorld& physics = hosting_.physics();
  const Eigen::Vector3f direction = look_direction(avatar.yaw, avatar.pitch);
  const Eigen::Vector3f own = physics.state(avatar.body()).linear_velocity;
  if (avatar.carried != BodyId{}) {
    // What is in the hand is thrown first; heavy things fly less far.
    const auto& definition = hosting_.definitions()[physics.prototype(avatar.carried).value];
    const float speed = std::clamp(60.0f / std::sqrt(definition.mass_kg), 5.0f, 18.0f);
    physics.set_velocity(avatar.carried, own + direction * speed, Eigen::Vector3f::Zero());
    avatar.carried = BodyId{};
    return;
  }
  if (!room) return;
  const Throwable& item = world_.throwables[command.item % world_.throwables.size()];
  const float size = bounding_radius(hosting_.definitions()[item.prototype.value].shape);
  NewBody body{BodyId::thrown(avatar.player, avatar.thrown), item.prototype, {}};
  body.state.position = WorldPosition::from(
      Eigen::Vector3d(eye(avatar).vector() + (direction * (0.5f + size)).cast<double>()));
  body.state.linear_velocity = own + direction * item.speed_mps;
  if (!hosting_.hosts(body.id)) hosting_.spawn(std::span(&body, 1), avatar.session);
  ++avatar.thrown;

  const std::uint32_t cap = world_.max_thrown_per_player;
  if (avatar.thrown <= cap) return;
  remove_thrown(avatar.player, avatar.thrown - cap - 1, out);  // The oldest goes first.
}

void Players::remove_thrown(PlayerId player, std::uint32_t n, PlayerOutput& out) {
  const BodyId body = BodyId::thrown(player, n);
  if (!hosting_.hosts(body)) {
    out.effects.removals.push_back(body);  // It may be anywhere by now.
    return;
  }
  hosting_.remove(std::span(&body, 1));
  forget(body);
}

bool Players::attach(Avatar& avatar, BodyId body) {
  const PhysicsWorld& physics = hosting_.physics();
  if (body.kind() == BodyId::Kind::avatar || carrier_of(body) != BodyId{}) return false;
  const auto& definition = hosting_.definitions()[physics.prototype(body).value];
  if (definition.mass_kg > tuning_.carry_mass_max_kg) return false;
  const double away = distance(eye(avatar), physics.position(body));
  if (away > tuning_.carry_reach_m) return false;
  avatar.carried = body;
  avatar.carried_distance_m =
      std::clamp(1.1f + bounding_radius(definition.shape), 1.4f, carried_distance_max_m);
  return true;
}

void Players::grab(Avatar& avatar, BodyId target, Tick now, PlayerOutput& out) {
  if (avatar.carried != BodyId{}) {
    avatar.carried = BodyId{};
    return;
  }
  if (target == BodyId{}) return;
  if (hosting_.hosts(target)) {
    attach(avatar, target);
    return;
  }
  reaching_[avatar.player] = {target, now};
  out.effects.requests.push_back({target, avatar.player});
}

void Players::blast(const Avatar& avatar, const PlayerCommand& command, Tick now,
                    PlayerOutput& out) {
  out.effects.blasts.push_back({(std::uint64_t{avatar.player.value} << 32) | command.sequence,
                                now + blast_lead_ticks_, hosting_.physics().position(avatar.body()),
                                tuning_.blast_radius_m, tuning_.blast_speed_mps, avatar.body()});
}

void Players::respawn(PlayerId player, std::uint16_t spawn) {
  Avatar& avatar = avatars_.at(player);
  avatar.carried = BodyId{};
  hosting_.physics().set_state(avatar.body(), standing_at(spawn, player));
}

void Players::remove_avatar(PlayerId player, PlayerOutput& out) {
  const std::uint32_t thrown = avatars_.at(player).thrown;
  const BodyId body = BodyId::avatar(player);
  hosting_.remove(std::span(&body, 1));
  reaching_.erase(player);
  avatars_.erase(player);
  for (std::uint32_t n = thrown - std::min(thrown, world_.max_thrown_per_player); n < thrown; ++n)
    remove_thrown(player, n, out);
}

void Players::drive(Tick now, bool room, PlayerOutput& out) {
  std::vector<PlayerId> held, gone;
  for (const auto& [player, avatar] : avatars_)
    if (!avatar.waiting.empty()) held.push_back(player);
  for (PlayerId player : held) apply_waiting(player, now, room, out);
  for (auto& [player, avatar] : avatars_) {
    if (!avatar.connected) {
      if (now - avatar.lost_since >= keep_lost_ticks) gone.push_back(player);
      if (now - avatar.lost_since >= stop_lost_ticks) avatar.keys = 0;
    }
    if (!drive_avatar(hosting_.physics(), avatar, tuning_, half_height_)) avatar.carried = BodyId{};
  }
  for (PlayerId player : gone) remove_avatar(player, out);
  std::erase_if(moved_, [&](const auto& m) { return now - m.second.when > remember_moved_ticks; });
  std::erase_if(reaching_, [&](const auto& r) { return now - r.second.since > reach_ticks; });
}

void Players::gateway_down(std::uint16_t gateway, Tick now) {
  for (auto& [player, avatar] : avatars_) {
    if (avatar.gateway != gateway || !avatar.connected) continue;
    avatar.connected = false;
    avatar.lost_since = now;
  }
}

std::vector<Avatar> Players::release(std::span<const BodyId> ids, RegionId to, Tick now) {
  std::vector<Avatar> leaving;
  for (BodyId id : ids) {
    if (id.kind() != BodyId::Kind::avatar) continue;
    auto node = avatars_.extract(id.player());
    if (node.empty()) continue;
    moved_[id.player()] = {to, node.mapped().session, now};
    reaching_.erase(id.player());
    leaving.push_back(std::move(node.mapped()));
  }
  for (auto& [player, avatar] : avatars_)
    if (std::find(ids.begin(), ids.end(), avatar.carried) != ids.end()) avatar.carried = BodyId{};
  return leaving;
}

void Players::accept(std::vector<Avatar> avatars, std::span<const BodyId> arrived, Tick now,
                     bool room, PlayerOutput& out) {
  for (Avatar& avatar : avatars) {
    const PlayerId player = avatar.player;
    if (!hosting_.hosts(avatar.body())) continue;
    if (avatar.carried != BodyId{} && !hosting_.hosts(avatar.carried)) avatar.carried = BodyId{};
    moved_.erase(player);
    // Until it has been looked at here: it came because others are near.
    avatar.company = true;
    // Nobody honest holds anything back for longer.
    avatar.held_until = std::min(avatar.held_until, now + wind_up_ticks_);
    avatars_.insert_or_assign(player, std::move(avatar));
    apply_waiting(player, now, room, out);
  }
  for (auto it = reaching_.begin(); it != reaching_.end();) {
    const auto owner = avatars_.find(it->first);
    const bool here = std::find(arrived.begin(), arrived.end(), it->second.target) != arrived.end();
    if (here && owner != avatars_.end()) attach(owner->second, it->second.target);
    it = here || owner == avatars_.end() ? reaching_.erase(it) : std::next(it);
  }
}

void Players::forget(BodyId removed) {
  for (auto& [player, avatar] : avatars_)
    if (avatar.carried == removed) avatar.carried = BodyId{};
}

BodyId Players::carrier_of(BodyId body) const {
  for (const auto& [player, avatar] : avatars_)
    if (avatar.carried == body) return avatar.body();
  return {};
}

std::vector<const Avatar*> Players::avatars() const {
  std::vector<const Avatar*> all;
  for (const auto& [player, avatar] : avatars_) all.push_back(&avatar);
  return all;
}

}  // namespace aureole
