// Handoff groups and player commands to bytes and back; everything that is read is checked.
#include "server/region/handoff/handoff.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "protocol/wire_values.h"
#include "server/base/check.h"
#include "server/physics/physics_world.h"

namespace aureole {
namespace {

/// The contacts of a message take at most so many bytes; together with max_handoff_bodies bodies
/// they fit a frame.
constexpr std::size_t contacts_bytes_max = 5u << 20;
/// Heavier blows than between the heaviest and fastest bodies of any world are made up (N s).
constexpr float impulse_max = 1e10f;

using aureole::from_wire;
using aureole::to_wire;

Bytes payload_of(flatbuffers::FlatBufferBuilder& builder) {
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {bytes.begin(), bytes.end()};
}

wire::Command to_wire(const PlayerCommand& c) {
  return {c.player.value, c.session, c.sequence, static_cast<wire::CommandKind>(c.kind),
          c.keys,         c.item,    c.gateway,  c.target.value,
          c.yaw,          c.pitch,   c.spawn};
}

Result<PlayerCommand> from_wire(const wire::Command& c) {
  if (c.player() == 0) return Error{"a command names player 0; expected a player"};
  if (static_cast<unsigned>(c.kind()) > static_cast<unsigned>(wire::CommandKind::MAX))
    return Error::format("a command of unknown kind {}", static_cast<unsigned>(c.kind()));
  if (!std::isfinite(c.yaw()) || !std::isfinite(c.pitch()) || std::abs(c.yaw()) > 1e6f ||
      std::abs(c.pitch()) > 1.6f)
    return Error{"a command's view angles are out of range"};
  if (c.item() > 3) return Error::format("a command names item {}; expected 0 to 3", c.item());
  if (c.session() > session_max)
    return Error::format("a command of session {}; expected at most {}", c.session(), session_max);
  const BodyId target{c.target()};
  if (target != BodyId{} && !target.valid()) return Error{"a command names a body that cannot be"};
  return PlayerCommand{PlayerId{c.player()},
                       c.session(),
                       c.sequence(),
                       static_cast<PlayerCommand::Kind>(c.kind()),
                       c.keys(),
                       c.item(),
                       c.gateway(),
                       target,
                       c.yaw(),
                       c.pitch(),
                       c.spawn()};
}

wire::HandoffBody to_wire(const HandoffGroup::Body& b) {
  const BodyState& s = b.body.state;
  return {b.body.id.value,
          b.epoch,
          b.body.prototype.value,
          static_cast<std::uint8_t>(s.activation),
          b.still_ticks,
          to_wire(s.position),
          to_wire(s.orientation),
          to_wire(s.linear_velocity),
          to_wire(s.angular_velocity),
          s.deactivation_time_s,
          b.owned_ticks};
}

Result<HandoffGroup::Body> from_wire(const wire::HandoffBody& b, std::size_t prototypes) {
  const BodyId id{b.id()};
  if (!id.valid()) return Error::format("handoff of body {:#x}, which cannot be", b.id());
  if (b.prototype() >= prototypes)
    return Error::format("handoff of body {:#x} with prototype {}; this world has {}", b.id(),
                         b.prototype(), prototypes);
  if (b.activation() > 2)
    return Error::format("handoff of body {:#x} with activation {}; expected 0 to 2", b.id(),
                         b.activation());
  BodyState state{from_wire(b.position()),
                  from_wire(b.orientation()),
                  from_wire(b.linear_velocity()),
                  from_wire(b.angular_velocity()),
                  static_cast<Activation>(b.activation()),
                  b.deactivation_time_s()};
  if (!may_travel(state))
    return Error::format(
        "handoff of body {:#x} with numbers that are not finite, out of range or no rotation",
        b.id());
  return HandoffGroup::Body{
      {id, PrototypeId{b.prototype()}, state}, b.epoch(), b.still_ticks(), b.owned_ticks()};
}

wire::HandoffPoint to_wire(const ContactPoint& p) {
  return {to_wire(p.local_on_a),
          to_wire(p.local_on_b),
          to_wire(p.normal_on_b),
          p.distance,
          p.impulse,
          p.impulse_lateral_1,
          p.impulse_lateral_2,
          to_wire(p.lateral_1),
          to_wire(p.lateral_2),
          p.age_steps,
          p.flags,
          p.child_a,
          p.child_b};
}

Result<ContactPoint> from_wire(const wire::HandoffPoint& p) {
  ContactPoint point{from_wire(p.local_on_a()),
                     from_wire(p.local_on_b()),
                     from_wire(p.normal_on_b()),
                     p.distance(),
                     p.impulse(),
                     p.impulse_lateral_1(),
                     p.impulse_lateral_2(),
                     from_wire(p.lateral_1()),
                     from_wire(p.lateral_2()),
                     p.age_steps(),
                     p.flags(),
                     p.child_a(),
                     p.child_b()};
  const bool finite = point.local_on_a.allFinite() && point.local_on_b.allFinite() &&
                      point.normal_on_b.allFinite() && point.lateral_1.allFinite() &&
                      point.lateral_2.allFinite() && std::isfinite(point.distance) &&
                      std::isfinite(point.impulse) && std::isfinite(point.impulse_lateral_1) &&
                      std::isfinite(point.impulse_lateral_2);
  if (!finite) return Error{"a contact in a handoff has numbers that are not finite"};
  if (point.child_a < -1 || point.child_a > 64 || point.child_b < -1 || point.child_b > 64)
    return Error{"a contact in a handoff names a child shape that cannot be"};
  return point;
}

bool in_group(const HandoffGroup& group, BodyId id) {
  return std::binary_search(group.bodies.begin(), group.bodies.end(),
                            HandoffGroup::Body{{id, {}, {}}, 0, 0},
                            [](const auto& a, const auto& b) { return a.body.id < b.body.id; });
}

Result<ContactManifold> from_wire(const wire::HandoffManifold& m, const HandoffGroup& group,
                                  std::size_t statics) {
  const auto stays_behind = [&](BodyId id) {
    return std::binary_search(group.stand_ins.begin(), group.stand_ins.end(), NewBody{id, {}, {}},
                              [](const auto& a, const auto& b) { return a.id < b.id; });
  };
  const auto known = [&](BodyId id) { return in_group(group, id) || stays_behind(id); };
  ContactManifold manifold;
  manifold.a = BodyId{m.a()};
  manifold.ordinal = m.ordinal();
  if (m.b_body() != 0) {
    manifold.b = BodyId{m.b_body()};
    const BodyId b{m.b_body()};
    if (!known(b) || m.a() == m.b_body() || (!in_group(group, b) && !in_group(group, manifold.a)))
      return Error{"a contact in a handoff names a body outside the group"};
  } else {
    if (m.b_static() >= statics) return Error{"a contact in a handoff names unknown geometry"};
    manifold.b = StaticId{m.b_static()};
  }
  const bool on_geometry = m.b_body() == 0;
  if (on_geometry ? !in_group(group, manifold.a) : !known(manifold.a))
    return Error{"a contact in a handoff names a body outside the group"};
  if (m.points() == nullptr || m.points()->size() == 0 || m.points()->size() > 4)
    return Error{"a contact in a handoff has not 1 to 4 points"};
  for (const auto* p : *m.points()) {
    auto point = from_wire(*p);
    if (!point) return point.error();
    manifold.points.push_back(*point);
  }
  if (!may_travel(manifold))
    return Error{"a contact in a handoff has no direction, or an impulse that cannot be"};
  return manifold;
}

Result<Avatar> from_wire(const wire::HandoffPlayer& p) {
  if (p.player() == 0) return Error{"a handoff carries player 0"};
  if (!std::isfinite(p.yaw()) || !std::isfinite(p.pitch()) ||
      !(p.carried_distance_m() >= 0 && p.carried_distance_m() < 100))
    return Error{"a player in a handoff has numbers out of range"};
  if (p.session() > session_max || !is_wire_tick(p.lost_since_tick()) ||
      !is_wire_tick(p.active_tick()) || !is_wire_tick(p.held_until_tick()))
    return Error{"a player in a handoff has a session or a tick that cannot be"};
  if (BodyId{p.carried()}.kind() == BodyId::Kind::avatar)
    return Error{"a player in a handoff carries an avatar"};
  Avatar avatar;
  avatar.player = PlayerId{p.player()};
  avatar.session = p.session();
  avatar.applied_sequence = p.applied_sequence();
  avatar.gateway = p.gateway();
  avatar.connected = p.connected();
  avatar.lost_since = Tick{p.lost_since_tick()};
  avatar.keys = p.keys();
  avatar.yaw = p.yaw();
  avatar.pitch = p.pitch();
  avatar.active = Tick{p.active_tick()};
  avatar.held_until = Tick{p.held_until_tick()};
  avatar.thrown = p.thrown();
  avatar.carried = BodyId{p.carried()};
  avatar.carried_distance_m = p.carried_distance_m();
  if (p.waiting() != nullptr) {
    if (p.waiting()->size() > Avatar::max_waiting)
      return Error{"a player in a handoff brings too many commands"};
    for (const auto* c : *p.waiting()) {
      auto command = from_wire(*c);
      if (!command) return command.error();
      avatar.waiting.emplace(command->sequence, *command);
    }
  }
  return avatar;
}

}  // namespace

wire::Resting encode_resting(const NewBody& body) {
  return {body.id.value, to_wire(body.state.position), to_wire(body.state.orientation),
          body.prototype.value};
}

Result<NewBody> decode_resting(const wire::Resting& resting, std::size_t prototypes) {
  NewBody body{BodyId{resting.id()}, PrototypeId{resting.prototype()}, {}};
  body.state.position = from_wire(resting.position());
  body.state.orientation = from_wire(resting.orientation());
  body.state.activation = Activation::asleep;
  if (!body.id.valid() || resting.prototype() >= prototypes || !may_travel(body.state))
    return Error::format(
        "a resting body {:#x} of prototype {} that cannot be, or whose pose is out of range",
        resting.id(), resting.prototype());
  return body;
}

bool may_travel(const BodyState& state) {
  return is_sane(state) && state.position.vector().cwiseAbs().maxCoeff() <= travel_distance_max_m &&
         state.linear_velocity.cwiseAbs().maxCoeff() <= travel_speed_max &&
         state.angular_velocity.cwiseAbs().maxCoeff() <= travel_speed_max;
}

bool may_travel(const ContactManifold& manifold) {
  const auto is_possible = [](const ContactPoint& p) {
    return p.impulse <= impulse_max && std::abs(p.impulse_lateral_1) <= impulse_max &&
           std::abs(p.impulse_lateral_2) <= impulse_max && p.lateral_1.norm() <= 1.01f &&
           p.lateral_2.norm() <= 1.01f;
  };
  return is_sane(manifold) &&
         std::all_of(manifold.points.begin(), manifold.points.end(), is_possible);
}

Bytes encode_handoff(const HandoffGroup& group) {
  AUREOLE_CHECK(group.bodies.size() <= max_handoff_bodies, "larger groups are cut by their sender");
  flatbuffers::FlatBufferBuilder builder(1024 + group.bodies.size() * 256);
  std::vector<wire::HandoffBody> bodies;
  bodies.reserve(group.bodies.size());
  for (const auto& b : group.bodies) bodies.push_back(to_wire(b));

  std::vector<flatbuffers::Offset<wire::HandoffManifold>> manifolds;
  manifolds.reserve(group.contacts.size());
  std::vector<wire::HandoffPoint> points;
  for (const auto& m : group.contacts) {
    // What does not fit a frame is found anew by collision detection, only less gently.
    if (builder.GetSize() > contacts_bytes_max) break;
    points.clear();
    for (const auto& p : m.points) points.push_back(to_wire(p));
    const auto* body = std::get_if<BodyId>(&m.b);
    const auto* geometry = std::get_if<StaticId>(&m.b);
    manifolds.push_back(wire::CreateHandoffManifold(builder, m.a.value, body ? body->value : 0,
                                                    geometry ? geometry->value : 0, m.ordinal,
                                                    builder.CreateVectorOfStructs(points)));
  }

  std::vector<flatbuffers::Offset<wire::HandoffPlayer>> players;
  for (const auto& a : group.avatars) {
    std::vector<wire::Command> waiting;
    for (const auto& [sequence, command] : a.waiting) waiting.push_back(to_wire(command));
    players.push_back(wire::CreateHandoffPlayer(
        builder, a.player.value, a.session, a.applied_sequence, a.gateway, a.connected,
        a.lost_since.value, a.keys, a.yaw, a.pitch, a.active.value, a.thrown, a.carried.value,
        a.carried_distance_m, builder.CreateVectorOfStructs(waiting), a.held_until.value));
  }
  std::vector<wire::Resting> stand_ins;
  for (const NewBody& body : group.stand_ins) stand_ins.push_back(encode_resting(body));
  builder.Finish(wire::CreateHandoff(builder, group.tick.value,
                                     builder.CreateVectorOfStructs(bodies),
                                     builder.CreateVector(manifolds), builder.CreateVector(players),
                                     builder.CreateVectorOfStructs(stand_ins)));
  return payload_of(builder);
}

Result<HandoffGroup> decode_handoff(std::span<const std::byte> payload, std::size_t prototypes,
                                    std::size_t statics) {
  const auto* message = verified<wire::Handoff>(payload);
  if (message == nullptr) return Error{"a handoff is not a valid message"};
  if (message->bodies() == nullptr || message->bodies()->size() == 0 ||
      message->bodies()->size() > max_handoff_bodies)
    return Error::format("a handoff must carry 1 to {} bodies", max_handoff_bodies);

  if (!is_wire_tick(message->tick()))
    return Error::format("a handoff of tick {}; expected at most {} from 0", message->tick(),
                         wire_tick_max);

  HandoffGroup group;
  group.tick = Tick{message->tick()};
  for (const auto* b : *message->bodies()) {
    auto body = from_wire(*b, prototypes);
    if (!body) return body.error();
    if (!group.bodies.empty() && !(group.bodies.back().body.id < body->body.id))
      return Error{"the bodies of a handoff are not in ascending order"};
    group.bodies.push_back(*body);
  }
  if (message->stand_ins() != nullptr) {
    if (message->stand_ins()->size() > max_handoff_bodies)
      return Error::format("a handoff leaves more than {} bodies behind", max_handoff_bodies);
    for (const auto* s : *message->stand_ins()) {
      auto body = decode_resting(*s, prototypes);
      if (!body) return body.error();
      if (!group.stand_ins.empty() && !(group.stand_ins.back().id < body->id))
        return Error{"the bodies that a handoff leaves behind are not in ascending order"};
      group.stand_ins.push_back(*body);
    }
  }
  if (message->manifolds() != nullptr) {
    std::size_t points = 0;
    for (const auto* m : *message->manifolds()) {
      auto manifold = from_wire(*m, group, statics);
      if (!manifold) return manifold.error();
      // Offsets may lead to one place again and again; memory is only for what has travelled.
      points += manifold->points.size();
      if (points * sizeof(wire::HandoffPoint) > payload.size())
        return Error{"a handoff names the same contacts several times"};
      group.contacts.push_back(std::move(*manifold));
    }
  }
  if (message->players() != nullptr) {
    std::set<PlayerId> players;
    std::size_t waiting = 0;
    for (const auto* p : *message->players()) {
      auto avatar = from_wire(*p);
      if (!avatar) return avatar.error();
      if (!in_group(group, avatar->body()))
        return Error{"a handoff carries a player without its avatar"};
      if (!players.insert(avatar->player).second)
        return Error::format("a handoff carries player {} twice", avatar->player.value);
      waiting += avatar->waiting.size();
      if (waiting * sizeof(wire::Command) > payload.size())
        return Error{"a handoff names the same commands several times"};
      group.avatars.push_back(std::move(*avatar));
    }
  }
  return group;
}

Bytes encode_commands(std::span<const PlayerCommand> commands) {
  flatbuffers::FlatBufferBuilder builder(64 + commands.size() * sizeof(wire::Command));
  std::vector<wire::Command> list;
  for (const auto& c : commands) list.push_back(to_wire(c));
  builder.Finish(wire::CreateCommands(builder, builder.CreateVectorOfStructs(list)));
  return payload_of(builder);
}

Result<std::vector<PlayerCommand>> decode_commands(std::span<const std::byte> payload) {
  const auto* message = verified<wire::Commands>(payload);
  if (message == nullptr || message->commands() == nullptr)
    return Error{"a commands message is not valid"};
  if (message->commands()->size() > max_commands)
    return Error::format("more than {} commands in one message", max_commands);
  std::vector<PlayerCommand> commands;
  for (const auto* c : *message->commands()) {
    auto command = from_wire(*c);
    if (!command) return command.error();
    commands.push_back(*command);
  }
  return commands;
}

}  // namespace aureole
