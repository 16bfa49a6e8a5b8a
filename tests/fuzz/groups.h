// Groups of bodies for the seeds of fuzz targets: valid, and with everything that one can carry.
#pragma once

#include "server/region/handoff/handoff.h"

namespace aureole::fuzz {

inline constexpr std::size_t prototypes = 4, statics = 4;

inline PlayerCommand a_command(std::uint32_t player, std::uint32_t sequence) {
  PlayerCommand command;
  command.player = PlayerId{player};
  command.session = 12;
  command.sequence = sequence;
  command.kind = PlayerCommand::Kind::grab;
  command.target = BodyId::world(11);
  command.item = 3;
  command.yaw = 1.5f;
  command.pitch = -0.5f;
  return command;
}

/// Bodies of the world from number 10 in a row, each on the ground and against the next one, the
/// last against one that stays behind; and an avatar for each player.
inline HandoffGroup a_group(std::uint32_t bodies, std::uint32_t players) {
  HandoffGroup group;
  group.tick = Tick{600};
  for (std::uint32_t n = 0; n < bodies; ++n) {
    NewBody body{BodyId::world(10 + n), PrototypeId{1}, {}};
    body.state.position = {1.0 * n, 0.5, -2};
    body.state.linear_velocity = {1, 2, 3};
    body.state.activation = static_cast<Activation>(n % 3);
    group.bodies.push_back({body, 4 + n, 7});
    ContactPoint point;
    point.impulse = 0.75f;
    point.age_steps = 9;
    point.lateral_1 = {1, 0, 0};
    ContactManifold contact{body.id, StaticId{2}, 1, {point, point, point}};
    group.contacts.push_back(contact);
    contact.b = BodyId::world(11 + n);
    group.contacts.push_back(contact);
  }
  group.stand_ins.push_back({BodyId::world(10 + bodies), PrototypeId{0}, {}});
  for (std::uint32_t n = 1; n <= players; ++n) {
    Avatar avatar;
    avatar.player = PlayerId{n};
    avatar.session = 12;
    avatar.applied_sequence = 34;
    avatar.carried = BodyId::world(10);
    for (std::uint32_t ahead : {36u, 37u}) avatar.waiting.emplace(ahead, a_command(n, ahead));
    group.bodies.push_back({{avatar.body(), PrototypeId{3}, {}}, 77, 0});
    group.avatars.push_back(avatar);
  }
  return group;
}

}  // namespace aureole::fuzz
