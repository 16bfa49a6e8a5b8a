// One player's commands on their way to the region that owns the avatar: in order, sent again until
// applied.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/wire.h"
#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

/// What a player wants, before it has a place in the stream.
struct CommandIntent {
  wire::CommandKind kind = wire::CommandKind::input;
  std::uint8_t keys = 0;
  std::uint8_t item = 0;  ///< throw_body: 0 … 3
  BodyId target{};
  float yaw = 0, pitch = 0;
  std::uint32_t browser_seq = 0;  ///< The browser's own number; 0 for what the gateway adds itself.
};

struct CommandStreamOptions {
  PlayerId player;
  std::uint16_t gateway = 0;
  std::uint32_t session = 0;
  std::uint16_t spawn = 0;  ///< Index of the spawn point, for join and respawn.
};

/// Pure: the caller reads the clock (µs). A session begins with `join` as sequence 1. Regions apply
/// a command once, in order; whatever is not applied yet is kept here and sent again, so that
/// neither a handoff of the avatar nor a broken link loses an input. When the owner turns out to
/// know less than it had confirmed (it was rebuilt from an older state), the session is begun anew
/// under a higher number with everything that is not applied yet.
class CommandStream {
 public:
  /// A player is disconnected when so many commands wait to be applied.
  static constexpr std::size_t max_unapplied = 256;
  /// Everything that is not applied is sent again after this time.
  static constexpr std::int64_t resend_us = 100'000;
  /// A confirmation that goes back must stay for this long before the session begins anew.
  static constexpr std::int64_t rewind_patience_us = 300'000;

  explicit CommandStream(const CommandStreamOptions& options);

  /// Appends a command. An `input` that changes nothing but the angles takes the place of the last
  /// one if that was an input with the same keys and has not been sent yet. False if it is full.
  [[nodiscard]] bool push(const CommandIntent& intent);

  /// What the owner of the avatar says, as of world time `tick`.
  void confirm(std::uint32_t session, std::uint32_t applied, Tick tick, std::int64_t now_us);

  /// Whether the avatar exists somewhere: then a join takes it over and never makes another one.
  void set_avatar_exists(bool exists) { avatar_exists_ = exists; }

  /// Commands to send to `owner` now: those never sent, or all if the owner has changed or has
  /// confirmed nothing for resend_us.
  std::vector<wire::Command> due(RegionId owner, std::int64_t now_us);

  /// True once the owner has gone back behind what it had confirmed, for long enough.
  bool must_restart(std::int64_t now_us) const;
  /// Begins again under `session` (greater than before): join, then all that was not applied.
  void restart(std::uint32_t session);

  std::uint32_t session() const { return options_.session; }
  /// True once another connection of the same player, here or at another gateway, has taken over.
  bool superseded() const { return superseded_; }
  bool all_applied() const { return unapplied_.empty(); }
  std::size_t unapplied() const { return unapplied_.size(); }
  /// The latest command of `kind` that is not applied yet.
  std::optional<CommandIntent> latest_unapplied(wire::CommandKind kind) const;

  /// The newest browser input that the world contains at world time `world_us`.
  std::uint32_t contained_input(std::int64_t world_us) const;

 private:
  struct Waiting {
    std::uint32_t sequence;
    CommandIntent intent;
    bool sent = false;
  };
  struct Confirmation {
    std::int64_t world_us;
    std::uint32_t browser_seq;
  };
  void append(const CommandIntent& intent);
  wire::Command on_wire(const Waiting& waiting) const;

  CommandStreamOptions options_;
  std::deque<Waiting> unapplied_;  ///< Ascending by one.
  std::uint32_t next_sequence_ = 1;
  std::uint32_t applied_browser_seq_ = 0;
  std::deque<Confirmation> history_;  ///< Ascending in both; of the last half second or so.
  std::optional<RegionId> last_owner_;
  std::int64_t last_sent_us_ = 0;
  std::optional<std::int64_t> rewound_since_us_;
  bool superseded_ = false;
  bool avatar_exists_ = false;
};

}  // namespace aureole
