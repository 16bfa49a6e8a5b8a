// What browser and gateway say to each other: reading it with suspicion, writing it exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/world_position.h"

namespace aureole {

/// See protocol/WIRE_FORMAT.md, "Browser ↔ gateway".
inline constexpr int browser_protocol_version = 1;
inline constexpr std::size_t max_browser_message_bytes = 4096;
inline constexpr std::size_t max_player_name_characters = 24;

/// Picture sizes that a browser may ask for (unit: pixels).
inline constexpr int min_picture_width = 160, max_picture_width = 1920;
inline constexpr int min_picture_height = 90, max_picture_height = 1080;

/// Bits of InputMessage::keys.
namespace input_keys {
inline constexpr std::uint8_t forward = 1, back = 2, left = 4, right = 8, jump = 16, sprint = 32;
inline constexpr std::uint8_t all = 63;
}  // namespace input_keys

struct JoinMessage {
  std::string token;  ///< 32 lower-case hex digits, or empty for a new player.
  std::string name;   ///< Sanitised; never empty.
  int width = 1280, height = 720;
};

/// Where a player looks (unit: rad). Yaw 0 looks along -z and grows to the left; pitch grows
/// upwards.
struct Look {
  float yaw = 0;    ///< -pi … pi
  float pitch = 0;  ///< -1.55 … 1.55
};

struct InputMessage {
  std::uint32_t seq = 0;
  std::uint8_t keys = 0;
  Look look;
};

enum class PlayerAction : std::uint8_t { throw_body, grab, blast, respawn };

struct ActionMessage {
  std::uint32_t seq = 0;
  PlayerAction action{};
  Look look;
  std::uint8_t item = 1;  ///< 1 … 4; means something for throw_body only.
};

struct ViewMessage {
  int width = 1280, height = 720;
  bool region_colours = false;
  bool boundaries = false;
};

struct AckMessage {
  std::uint32_t frame = 0;
};

struct PingMessage {
  double t = 0;
};

struct LeaveMessage {};

using BrowserMessage = std::variant<JoinMessage, InputMessage, ActionMessage, ViewMessage,
                                    AckMessage, PingMessage, LeaveMessage>;

/// Reads one text message. Errors: too long, not JSON, nested deeper than 8, not an object, unknown
/// type, fields that are missing, of another kind, not finite or out of range.
Result<BrowserMessage> parse_browser_message(std::string_view text);

/// A name as others may see it: no control, formatting or direction characters, single spaces, at
/// most 24 characters (code points); "Player" if nothing is left. `name` must be valid UTF-8.
std::string sanitised_name(std::string_view name);

// ---- From the gateway ------------------------------------------------------------------------

struct RegionLabel {
  std::string name;
  std::uint32_t colour = 0;  ///< 0xrrggbb
};

struct WelcomeMessage {
  std::string token;
  PlayerId player;
  bool resumed = false;
  float yaw = 0;  ///< Where a new player looks at first; the page goes on with it.
  std::string world_name;
  std::string world_description;
  std::vector<RegionLabel> regions;
  std::array<std::string, 4> throwables;
};

struct StatusMessage {
  double fps = 0;
  std::size_t bodies = 0;
  std::size_t awake = 0;
  std::size_t players = 0;
  std::string region;  ///< Where the avatar is simulated; empty while nobody does.
  std::optional<WorldPosition> position;
  bool carrying = false;
  std::size_t regions_up = 0;
  std::size_t regions = 0;
  double world_time_s = 0;
  int quality = 0;
  double scale = 1;
  std::string notice;  ///< Something to tell the player once; left out if empty.
};

std::string welcome_text(const WelcomeMessage& message);
/// `missing`: names of the regions that a player has to wait for.
std::string waiting_text(const std::vector<std::string>& missing);
std::string status_text(const StatusMessage& message);
std::string pong_text(double t);
/// `message`: one sentence.
std::string error_text(std::string_view message);

/// What goes before the JPEG data of a picture.
struct PictureHeader {
  std::uint32_t number = 0;
  std::uint64_t world_us = 0;
  std::uint32_t input_seq = 0;  ///< Newest input of the browser that the world shown contains.
  std::uint16_t width = 0, height = 0;
  std::uint32_t made_in_us = 0;
};
inline constexpr std::size_t picture_header_bytes = 32;
std::array<std::byte, picture_header_bytes> encode_picture_header(const PictureHeader& header);

}  // namespace aureole
