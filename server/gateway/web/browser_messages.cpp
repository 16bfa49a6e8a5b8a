// Reading and writing the browser's messages; everything that comes in here is hostile.
#include "server/gateway/web/browser_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

namespace aureole {
namespace {

using Json = nlohmann::json;

constexpr int max_nesting = 8;
constexpr float pitch_limit = 1.55f;
/// Browsers sum up mouse movements in doubles; past this a yaw has lost its meaning.
constexpr double yaw_limit = 1e4;

/// Depth of brackets outside of strings; checked before anything is built from the text.
bool nested_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > max_nesting) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

/// Reads fields one by one and remembers the first mistake.
class Fields {
 public:
  Fields(const Json& object, std::string_view type) : object_(object), type_(type) {}

  const std::optional<Error>& error() const { return error_; }

  std::int64_t integer(const char* key, std::int64_t min, std::int64_t max) {
    const Json* value = required(key);
    if (!value) return min;
    if (!value->is_number_integer()) return wrong(key, "a whole number"), min;
    // Unsigned numbers past the signed range would wrap around.
    const bool huge =
        value->is_number_unsigned() &&
        value->get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
    const std::int64_t n = huge ? 0 : value->get<std::int64_t>();
    if (huge || n < min || n > max) {
      fail(fmt::format("\"{}\" of \"{}\" must be {} to {}", key, type_, min, max));
      return min;
    }
    return n;
  }

  double number(const char* key, double limit) {
    const Json* value = required(key);
    if (!value) return 0;
    if (!value->is_number()) return wrong(key, "a number"), 0;
    const double n = value->get<double>();
    if (!std::isfinite(n) || std::abs(n) > limit) {
      fail(fmt::format("\"{}\" of \"{}\" must be between -{} and {}", key, type_, limit, limit));
      return 0;
    }
    return n;
  }

  bool boolean(const char* key) {
    const Json* value = required(key);
    if (!value) return false;
    if (!value->is_boolean()) return wrong(key, "true or false"), false;
    return value->get<bool>();
  }

  std::string text(const char* key, std::size_t max_bytes) {
    const Json* value = required(key);
    if (!value) return {};
    if (!value->is_string()) return wrong(key, "a text"), std::string{};
    auto string = value->get<std::string>();
    if (string.size() > max_bytes) {
      fail(fmt::format("\"{}\" of \"{}\" must be at most {} bytes", key, type_, max_bytes));
      return {};
    }
    return string;
  }

  Look look() {
    const double yaw = number("yaw", yaw_limit);
    const double pitch = number("pitch", 1.6);
    return {static_cast<float>(std::remainder(yaw, 2 * std::numbers::pi)),
            std::clamp(static_cast<float>(pitch), -pitch_limit, pitch_limit)};
  }

  bool has(const char* key) const {
    const auto at = object_.find(key);
    return at != object_.end() && !at->is_null();
  }

  void fail(std::string sentence) {
    if (!error_) error_ = Error{std::move(sentence)};
  }

 private:
  const Json* required(const char* key) {
    const auto at = object_.find(key);
    if (at != object_.end()) return &*at;
    fail(fmt::format("\"{}\" needs the field \"{}\"", type_, key));
    return nullptr;
  }
  void wrong(const char* key, const char* expected) {
    fail(fmt::format("\"{}\" of \"{}\" must be {}", key, type_, expected));
  }

  const Json& object_;
  std::string_view type_;
  std::optional<Error> error_;
};

std::uint32_t read_seq(Fields& fields) {
  return static_cast<std::uint32_t>(fields.integer("seq", 1, 0xffff'ffff));
}

JoinMessage read_join(Fields& fields) {
  JoinMessage join;
  if (fields.integer("version", 0, 1'000'000) != browser_protocol_version)
    fields.fail(
        fmt::format("This page speaks another version of the protocol than the server's {}; "
                    "load the page again",
                    browser_protocol_version));
  if (fields.has("token")) {
    join.token = fields.text("token", 32);
    const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    for (char& c : join.token)
      if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
    if (join.token.size() != 32 || !std::all_of(join.token.begin(), join.token.end(), is_hex))
      fields.fail("\"token\" of \"join\" must be 32 hex digits");
  }
  join.name = sanitised_name(fields.has("name") ? fields.text("name", 512) : std::string{});
  join.width = static_cast<int>(fields.integer("width", min_picture_width, max_picture_width));
  join.height = static_cast<int>(fields.integer("height", min_picture_height, max_picture_height));
  return join;
}

ActionMessage read_action(Fields& fields) {
  ActionMessage message;
  message.seq = read_seq(fields);
  const std::string action = fields.text("action", 16);
  if (action == "throw") {
    message.action = PlayerAction::throw_body;
    message.item = static_cast<std::uint8_t>(fields.integer("item", 1, 4));
  } else if (action == "grab") {
    message.action = PlayerAction::grab;
  } else if (action == "blast") {
    message.action = PlayerAction::blast;
  } else if (action == "respawn") {
    message.action = PlayerAction::respawn;
  } else {
    fields.fail("\"action\" of \"action\" must be throw, grab, blast or respawn");
  }
  message.look = fields.look();
  return message;
}

/// Characters that could forge a line in a log or turn the text around them; U+2028/2029 break
/// lines.
bool is_printable(char32_t c) {
  if (c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0xad || c == 0xfeff) return false;
  if (c >= 0x200b && c <= 0x200f) return false;
  if (c >= 0x2028 && c <= 0x202e) return false;
  if (c >= 0x2060 && c <= 0x206f) return false;
  return c < 0xfff0 || (c >= 0x1'0000 && c < 0xe'0000);
}

struct CodePoint {
  char32_t value;
  std::size_t bytes;
};

/// The code point at the start of valid UTF-8; bytes that are not are taken one by one as
/// unprintable.
CodePoint first_code_point(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 1;
  if (length == 1 || text.size() < length) return {0, 1};
  char32_t value = lead & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {0, 1};
    value = (value << 6) | (byte(i) & 0x3fu);
  }
  return {value, length};
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string sanitised_name(std::string_view name) {
  std::string clean;
  std::size_t characters = 0;
  bool space_due = false;
  for (std::size_t at = 0; at < name.size() && characters < max_player_name_characters;) {
    const CodePoint c = first_code_point(name.substr(at));
    const std::string_view bytes = name.substr(at, c.bytes);
    at += c.bytes;
    if (c.value == ' ' || c.value == 0xa0 || c.value == '\t' || c.value == '\n') {
      space_due = !clean.empty();
      continue;
    }
    if (!is_printable(c.value)) continue;
    if (space_due) {
      if (characters + 2 > max_player_name_characters) break;
      clean += ' ';
      ++characters;
      space_due = false;
    }
    clean += bytes;
    ++characters;
  }
  return clean.empty() ? "Player" : clean;
}

Result<BrowserMessage> parse_browser_message(std::string_view text) {
  if (text.size() > max_browser_message_bytes)
    return Error::format("A message of {} bytes came; at most {} are allowed", text.size(),
                         max_browser_message_bytes);
  if (nested_too_deep(text))
    return Error::format("A message is nested deeper than {}", max_nesting);
  const Json object = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (object.is_discarded()) return Error{"A message is not JSON"};
  if (!object.is_object()) return Error{"A message must be a JSON object"};
  const auto type_at = object.find("type");
  if (type_at == object.end() || !type_at->is_string())
    return Error{"A message needs a text field \"type\""};
  const auto& type = type_at->get_ref<const std::string&>();

  Fields fields(object, type);
  BrowserMessage message;
  if (type == "input") {
    message = InputMessage{read_seq(fields),
                           static_cast<std::uint8_t>(fields.integer("keys", 0, input_keys::all)),
                           fields.look()};
  } else if (type == "action") {
    message = read_action(fields);
  } else if (type == "ack") {
    message = AckMessage{static_cast<std::uint32_t>(fields.integer("frame", 0, 0xffff'ffff))};
  } else if (type == "view") {
    ViewMessage view;
    view.width = static_cast<int>(fields.integer("width", min_picture_width, max_picture_width));
    view.height =
        static_cast<int>(fields.integer("height", min_picture_height, max_picture_height));
    view.region_colours = fields.boolean("region_colours");
    view.boundaries = fields.boolean("boundaries");
    message = view;
  } else if (type == "ping") {
    message = PingMessage{fields.number("t", 1e18)};
  } else if (type == "join") {
    message = read_join(fields);
  } else if (type == "leave") {
    message = LeaveMessage{};
  } else {
    return Error{"A message has a type that this server does not know"};
  }
  if (fields.error()) return *fields.error();
  return message;
}

std::string welcome_text(const WelcomeMessage& m) {
  Json regions = Json::array();
  for (const RegionLabel& region : m.regions)
    regions.push_back({{"name", region.name}, {"colour", fmt::format("#{:06x}", region.colour)}});
  return dumped({{"type", "welcome"},
                 {"version", browser_protocol_version},
                 {"token", m.token},
                 {"player", m.player.value},
                 {"resumed", m.resumed},
                 {"yaw", m.yaw},
                 {"world", {{"name", m.world_name}, {"description", m.world_description}}},
                 {"regions", std::move(regions)},
                 {"throwables", m.throwables},
                 {"tick_ms", 16}});
}

std::string waiting_text(const std::vector<std::string>& missing) {
  return dumped({{"type", "waiting"}, {"missing", missing}});
}

std::string status_text(const StatusMessage& m) {
  Json json = {{"type", "status"},
               {"fps", std::round(m.fps * 10) / 10},
               {"bodies", m.bodies},
               {"awake", m.awake},
               {"players", m.players},
               {"region", m.region},
               {"position", nullptr},
               {"carrying", m.carrying},
               {"regions_up", m.regions_up},
               {"regions", m.regions},
               {"world_time_s", m.world_time_s},
               {"quality", m.quality},
               {"scale", m.scale}};
  if (m.position) json["position"] = {m.position->x, m.position->y, m.position->z};
  if (!m.notice.empty()) json["notice"] = m.notice;
  return dumped(json);
}

std::string pong_text(double t) {
  return dumped({{"type", "pong"}, {"t", t}});
}

std::string error_text(std::string_view message) {
  return dumped({{"type", "error"}, {"message", message}});
}

std::array<std::byte, picture_header_bytes> encode_picture_header(const PictureHeader& header) {
  std::array<std::byte, picture_header_bytes> out{};
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(out.data() + at, &value,
                sizeof value);  // little-endian, asserted in protocol/frame
  };
  put(0, std::uint8_t{1});
  put(1, std::uint8_t{1});
  put(2, static_cast<std::uint16_t>(picture_header_bytes));
  put(4, header.number);
  put(8, header.world_us);
  put(16, header.input_seq);
  put(20, header.width);
  put(22, header.height);
  put(24, header.made_in_us);
  return out;
}

}  // namespace aureole
