// parse_browser_message: whatever a browser sends, what comes out is within the contract.
#include <cmath>
#include <string>

#include "server/gateway/web/browser_messages.h"
#include "tests/fuzz/fuzz_target.h"

using namespace aureole;

namespace {

void check(const Look& look) {
  FUZZ_EXPECT(std::isfinite(look.yaw) && std::abs(look.yaw) <= 3.1416f);
  FUZZ_EXPECT(std::isfinite(look.pitch) && std::abs(look.pitch) <= 1.55f);
}

void check_size(int width, int height) {
  FUZZ_EXPECT(width >= min_picture_width && width <= max_picture_width);
  FUZZ_EXPECT(height >= min_picture_height && height <= max_picture_height);
}

struct Check {
  void operator()(const JoinMessage& m) const {
    FUZZ_EXPECT(m.token.empty() || m.token.size() == 32);
    FUZZ_EXPECT(m.token.find_first_not_of("0123456789abcdef") == std::string::npos);
    FUZZ_EXPECT(!m.name.empty() && m.name.size() <= 4 * max_player_name_characters);
    for (const char c : m.name) FUZZ_EXPECT(static_cast<unsigned char>(c) >= 0x20);
    FUZZ_EXPECT(sanitised_name(m.name) == m.name);
    check_size(m.width, m.height);
  }
  void operator()(const InputMessage& m) const {
    FUZZ_EXPECT(m.seq >= 1 && m.keys <= input_keys::all);
    check(m.look);
  }
  void operator()(const ActionMessage& m) const {
    FUZZ_EXPECT(m.seq >= 1 && m.item >= 1 && m.item <= 4);
    check(m.look);
  }
  void operator()(const ViewMessage& m) const { check_size(m.width, m.height); }
  void operator()(const AckMessage&) const {}
  void operator()(const PingMessage& m) const {
    FUZZ_EXPECT(std::isfinite(m.t));
    FUZZ_EXPECT(!pong_text(m.t).empty());
  }
  void operator()(const LeaveMessage&) const {}
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto message = parse_browser_message(text);
  if (message) {
    std::visit(Check{}, *message);
  } else {
    FUZZ_EXPECT(!message.error().message.empty() && message.error().message.size() < 300);
    FUZZ_EXPECT(!error_text(message.error().message).empty());
  }
  // Names come from elsewhere too (a page's own text), valid UTF-8 or not.
  FUZZ_EXPECT(!sanitised_name(text).empty());
  return 0;
}

std::vector<Bytes> aureole_fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (
      const std::string text :
      {R"({"type":"join","version":1,"token":"0123456789abcdef0123456789ABCDEF","name":"Ada \u00e4\ud83d\ude00","width":1280,"height":720})",
       R"({"type":"input","seq":1,"keys":17,"yaw":-3.5,"pitch":1.2})",
       R"({"type":"action","seq":2,"action":"throw","item":4,"yaw":0,"pitch":0})",
       R"({"type":"action","seq":3,"action":"grab","yaw":1e2,"pitch":-1.5})",
       R"({"type":"view","width":640,"height":360,"region_colours":true,"boundaries":false})",
       R"({"type":"ack","frame":4294967295})", R"({"type":"ping","t":123.456})",
       R"({"type":"leave","extra":[[[{}]]]})"}) {
    const auto bytes = std::as_bytes(std::span(text));
    seeds.emplace_back(bytes.begin(), bytes.end());
  }
  return seeds;
}
