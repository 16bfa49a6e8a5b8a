// A group of bodies on its way to another server: as plain data, and as bytes.
#pragma once

#include <span>
#include <vector>

#include "protocol/frame.h"
#include "protocol/quantise.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/physics/body.h"
#include "server/region/players/avatar.h"

namespace aureole {

/// Longest that is remembered of how long somebody owned a body; it travels in a byte.
inline constexpr std::uint8_t owned_ticks_max = 255;

/// Bodies, the contacts among them and with the ground, and the players among them. The sender
/// stopped stepping it after step `tick`.
struct HandoffGroup {
  struct Body {
    NewBody body;
    std::uint32_t epoch = 0;       ///< Of the sender's ownership.
    std::uint8_t still_ticks = 0;  ///< See HostedBody.
    /// For how many ticks the sender owned it, at most owned_ticks_max.
    std::uint8_t owned_ticks = owned_ticks_max;
  };
  Tick tick;
  std::vector<Body> bodies;  ///< ascending
  /// Among the bodies, with the ground and with `stand_ins`; one side is always in `bodies`.
  std::vector<ContactManifold> contacts;
  std::vector<Avatar> avatars;
  /// Resting bodies that touch the group and stay behind; ascending. Only pose and prototype count.
  std::vector<NewBody> stand_ins;
};

namespace wire {
struct Resting;
}
/// A resting body as it travels in handoffs and auras messages, and back with every number checked.
wire::Resting encode_resting(const NewBody& body);
Result<NewBody> decode_resting(const wire::Resting& resting, std::size_t prototypes);

/// More bodies than this never travel in one message.
inline constexpr std::size_t max_handoff_bodies = 4096;

/// Bodies farther from the origin along any axis (m) or faster (m/s, rad/s) do not travel: whoever
/// hosts one takes it out of the world as a stray.
inline constexpr double travel_distance_max_m = 2 * position_limit_m;
inline constexpr float travel_speed_max = 10'000;
bool may_travel(const BodyState& state);
/// Contacts that may not are left behind by their sender, and refused by the receiver.
bool may_travel(const ContactManifold& manifold);

/// Payload of a FrameType::handoff. Contacts that do not fit a frame are left out.
Bytes encode_handoff(const HandoffGroup& group);

/// Verified and checked: ids valid and ascending, prototypes and statics known, numbers finite,
/// contacts and avatars only of bodies in the group.
Result<HandoffGroup> decode_handoff(std::span<const std::byte> payload, std::size_t prototypes,
                                    std::size_t statics);

/// More commands than this never travel in one message.
inline constexpr std::size_t max_commands = 4096;

/// Payload of a FrameType::commands, and back with every field checked.
Bytes encode_commands(std::span<const PlayerCommand> commands);
Result<std::vector<PlayerCommand>> decode_commands(std::span<const std::byte> payload);

}  // namespace aureole
