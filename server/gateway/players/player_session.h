// One player's state in the gateway: what was asked for, what is applied, what is to be drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/gateway/pictures/picture_pacing.h"
#include "server/gateway/players/command_stream.h"
#include "server/gateway/web/browser_messages.h"

namespace aureole {

/// Pure: no sockets, and the caller reads the clock (µs). Errors are sentences for the player, who
/// is disconnected with them.
class PlayerSession {
 public:
  struct Options {
    std::string token;
    std::string name;
    ViewMessage view;
    Look look;
    CommandStreamOptions stream;
  };
  explicit PlayerSession(const Options& options);

  PlayerId player() const { return player_; }
  const std::string& token() const { return token_; }
  const std::string& name() const { return name_; }

  /// The newest angles count for the camera at once. Inputs that change nothing but angles within
  /// one drawing interval become one command.
  Status input(const InputMessage& message, std::int64_t now_us);
  /// `target`: for grab, the body to take; 0 lets go.
  Status action(const ActionMessage& message, BodyId target, std::int64_t now_us);
  /// Gives up what input() held back for merging, when its time has come. Call 60 times a second.
  Status tick(std::int64_t now_us);
  /// The connection is gone (`lost`: the avatar stays for a while), or the player left for good.
  /// Nothing can be done if the stream is full; the region notices by itself in the end.
  void depart(bool lost);
  bool departed() const { return departed_; }

  void set_view(const ViewMessage& view) { view_ = view; }
  const ViewMessage& view() const { return view_; }
  Look look() const { return look_; }
  /// Keys held, as last passed on.
  std::uint8_t keys() const { return keys_; }
  /// Size of the next picture after adaptation: even numbers, at least the smallest that is
  /// allowed.
  int picture_width() const;
  int picture_height() const;

  /// Whether the player will be carrying something once all commands sent so far are applied.
  bool will_carry(bool carrying_now) const;

  CommandStream& commands() { return commands_; }
  const CommandStream& commands() const { return commands_; }
  PicturePacing& pacing() { return pacing_; }
  const PicturePacing& pacing() const { return pacing_; }

 private:
  Status accept_seq(std::uint32_t seq);
  Status flush(std::int64_t now_us);
  Status push(const CommandIntent& intent);

  PlayerId player_;
  std::string token_;
  std::string name_;
  ViewMessage view_;
  Look look_;
  std::uint8_t keys_ = 0;  ///< As last pushed.
  CommandStream commands_;
  PicturePacing pacing_;
  std::optional<InputMessage> held_;  ///< Waits to be merged with the next one.
  std::int64_t last_input_us_ = 0;
  std::uint32_t last_seq_ = 0;
  bool departed_ = false;
};

}  // namespace aureole
