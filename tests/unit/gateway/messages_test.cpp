// What browsers may say, what they may not, and what they are told.
#include "server/gateway/web/browser_messages.h"

#include <cmath>
#include <numbers>

#include "server/gateway/players/player_token.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::string refusal(std::string_view text) {
  const auto message = parse_browser_message(text);
  return message ? std::string() : message.error().message;
}

constexpr auto good_input = R"({"type":"input","seq":7,"keys":17,"yaw":0.5,"pitch":-0.25})";

}  // namespace

TEST_CASE("A browser's input arrives field by field") {
  const auto message = parse_browser_message(good_input);
  REQUIRE(message);
  const auto input = std::get<InputMessage>(*message);
  REQUIRE(input.seq == 7);
  REQUIRE(input.keys == (input_keys::forward | input_keys::jump));
  REQUIRE(input.look.yaw == 0.5f);
  REQUIRE(input.look.pitch == -0.25f);
}

TEST_CASE("A yaw that has turned many times means the same direction") {
  const double turned = 0.5 + 40 * std::numbers::pi;
  const auto message = parse_browser_message(
      fmt::format(R"({{"type":"input","seq":1,"keys":0,"yaw":{},"pitch":0}})", turned));
  REQUIRE(message);
  REQUIRE(std::get<InputMessage>(*message).look.yaw == Approx(0.5).margin(1e-5));
}

TEST_CASE("A join without token is a new player, with one it is the old") {
  const auto fresh =
      parse_browser_message(R"({"type":"join","version":1,"name":"Ada","width":640,"height":360})");
  REQUIRE(fresh);
  REQUIRE(std::get<JoinMessage>(*fresh).token.empty());
  REQUIRE(std::get<JoinMessage>(*fresh).name == "Ada");
  const auto again = parse_browser_message(
      R"({"type":"join","version":1,"token":"00112233445566778899AABBCCDDEEFF","width":640,"height":360})");
  REQUIRE(again);
  REQUIRE(std::get<JoinMessage>(*again).token == "00112233445566778899aabbccddeeff");
  REQUIRE(std::get<JoinMessage>(*again).name == "Player");
}

TEST_CASE("Each kind of action is understood, and only throwing needs an item") {
  const auto action = [](std::string_view text) {
    auto message = parse_browser_message(text);
    REQUIRE(message);
    return std::get<ActionMessage>(*message);
  };
  const auto thrown =
      action(R"({"type":"action","seq":1,"action":"throw","item":4,"yaw":0,"pitch":0})");
  REQUIRE(thrown.action == PlayerAction::throw_body);
  REQUIRE(thrown.item == 4);
  REQUIRE(action(R"({"type":"action","seq":1,"action":"grab","yaw":0,"pitch":0})").action ==
          PlayerAction::grab);
  REQUIRE(action(R"({"type":"action","seq":1,"action":"blast","yaw":0,"pitch":0})").action ==
          PlayerAction::blast);
  REQUIRE(action(R"({"type":"action","seq":1,"action":"respawn","yaw":0,"pitch":0})").action ==
          PlayerAction::respawn);
}

TEST_CASE("Messages that break the contract are refused with a sentence about the fault") {
  const auto [text, part] = GENERATE(table<std::string, std::string>({
      {"", "not JSON"},
      {"{", "not JSON"},
      {"[1,2]", "JSON object"},
      {R"("input")", "JSON object"},
      {R"({"a":1})", "\"type\""},
      {R"({"type":7})", "\"type\""},
      {R"({"type":"dance"})", "does not know"},
      {R"({"type":"input","keys":1,"yaw":0,"pitch":0})", "\"seq\""},
      {R"({"type":"input","seq":0,"keys":1,"yaw":0,"pitch":0})", "\"seq\""},
      {R"({"type":"input","seq":1.5,"keys":1,"yaw":0,"pitch":0})", "\"seq\""},
      {R"({"type":"input","seq":18446744073709551615,"keys":1,"yaw":0,"pitch":0})", "\"seq\""},
      {R"({"type":"input","seq":1,"keys":64,"yaw":0,"pitch":0})", "\"keys\""},
      {R"({"type":"input","seq":1,"keys":-1,"yaw":0,"pitch":0})", "\"keys\""},
      {R"({"type":"input","seq":1,"keys":1,"yaw":1e300,"pitch":0})", "\"yaw\""},
      {R"({"type":"input","seq":1,"keys":1,"yaw":"0","pitch":0})", "\"yaw\""},
      {R"({"type":"input","seq":1,"keys":1,"yaw":0,"pitch":2})", "\"pitch\""},
      {R"({"type":"action","seq":1,"action":"fly","yaw":0,"pitch":0})", "\"action\""},
      {R"({"type":"action","seq":1,"action":"throw","item":5,"yaw":0,"pitch":0})", "\"item\""},
      {R"({"type":"action","seq":1,"action":"throw","yaw":0,"pitch":0})", "\"item\""},
      {R"({"type":"view","width":159,"height":90,"region_colours":true,"boundaries":true})",
       "\"width\""},
      {R"({"type":"view","width":160,"height":1081,"region_colours":true,"boundaries":true})",
       "\"height\""},
      {R"({"type":"view","width":160,"height":90,"region_colours":1,"boundaries":true})",
       "\"region_colours\""},
      {R"({"type":"join","version":2,"width":640,"height":360})", "version"},
      {R"({"type":"join","version":1,"token":"abc","width":640,"height":360})", "\"token\""},
      {R"({"type":"join","version":1,"token":"0011223344556677889900112233445g","width":640,"height":360})",
       "\"token\""},
      {R"({"type":"ack","frame":4294967296})", "\"frame\""},
      {R"({"type":"ping","t":null})", "\"t\""},
  }));
  INFO(text);
  const std::string sentence = refusal(text);
  REQUIRE_FALSE(sentence.empty());
  REQUIRE(sentence.find(part) != std::string::npos);
}

TEST_CASE("A message is refused for its length and its nesting before it is parsed") {
  const std::string padded = std::string(good_input) + std::string(4096, ' ');
  REQUIRE(refusal(padded).find("4096") != std::string::npos);
  REQUIRE(refusal(std::string(4000, '[')).find("nested") != std::string::npos);
  REQUIRE(refusal(R"({"type":"leave","x":"[[[[[[[[[[[[[[[[["})").empty());
}

TEST_CASE("Names keep letters of all scripts and lose what could forge a line or turn the text") {
  REQUIRE(sanitised_name("Zoë 王小明 😀") == "Zoë 王小明 😀");
  REQUIRE(sanitised_name("  a \n\t b  ") == "a b");
  REQUIRE(sanitised_name("a\x1b[31mb\x7f") == "a[31mb");
  REQUIRE(sanitised_name("a\u202egnp.exe\u2066\u200b") == "agnp.exe");
  REQUIRE(sanitised_name("\xff\xc3") == "Player");
  REQUIRE(sanitised_name("") == "Player");
  REQUIRE(sanitised_name(std::string(100, 'x')) == std::string(24, 'x'));
  std::string umlauts, expected;
  for (int i = 0; i < 30; ++i) umlauts += "ü";
  for (int i = 0; i < 24; ++i) expected += "ü";
  REQUIRE(sanitised_name(umlauts) == expected);
}

TEST_CASE("A picture's header lies as the contract says, byte by byte") {
  PictureHeader header;
  header.number = 0x01020304;
  header.world_us = 0x1112131415161718;
  header.input_seq = 0x21222324;
  header.width = 1280;
  header.height = 720;
  header.made_in_us = 0x31323334;
  const auto bytes = encode_picture_header(header);
  const std::array<unsigned, 32> expected = {1,    1,    32,   0,    4,    3,    2,    1,
                                             0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11,
                                             0x24, 0x23, 0x22, 0x21, 0x00, 0x05, 0xd0, 0x02,
                                             0x34, 0x33, 0x32, 0x31, 0,    0,    0,    0};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    INFO("byte " << i);
    REQUIRE(std::to_integer<unsigned>(bytes[i]) == expected[i]);
  }
}

TEST_CASE("Status, pong and error are JSON with the fields of the contract") {
  StatusMessage status;
  status.region = "north \"west\"";
  status.position = WorldPosition{1, 2, 3};
  const std::string text = status_text(status);
  for (const char* field :
       {"\"type\":\"status\"", "\"fps\"", "\"bodies\"", "\"awake\"", "\"players\"",
        "\"region\":\"north \\\"west\\\"\"", "\"position\":[1.0,2.0,3.0]", "\"carrying\":false",
        "\"regions_up\"", "\"regions\"", "\"world_time_s\"", "\"quality\""})
    REQUIRE(text.find(field) != std::string::npos);
  REQUIRE(text.find("notice") == std::string::npos);
  status.notice = "Nothing is there";
  REQUIRE(status_text(status).find("\"notice\":\"Nothing is there\"") != std::string::npos);
  REQUIRE(pong_text(2.5) == R"({"t":2.5,"type":"pong"})");
  REQUIRE(error_text("No\nway") == R"({"message":"No\nway","type":"error"})");
}

TEST_CASE("A token is 128 random bits, and always stands for the same player") {
  const std::string a = make_player_token(), b = make_player_token();
  REQUIRE(a.size() == 32);
  REQUIRE(a.find_first_not_of("0123456789abcdef") == std::string::npos);
  REQUIRE(a != b);
  REQUIRE(player_of_token(a) == player_of_token(a));
  REQUIRE(player_of_token(a) != player_of_token(b));
  // Part of what all gateways of a world agree on: it must not change with the code.
  REQUIRE(player_of_token("00000000000000000000000000000000") == PlayerId{3770479864u});
}

TEST_CASE("Session numbers grow with the clock, and past any that is known already") {
  const std::int64_t now = 1'767'225'600'000;  // 2026-01-01
  const std::uint32_t first = next_session(now, 0);
  REQUIRE(first == 365u * 86'400u * 4u);
  REQUIRE(next_session(now, first) == first + 1);
  REQUIRE(next_session(now + 250, 0) == first + 1);
  REQUIRE(next_session(0, 5) == 6);  // a clock that has lost its date
}
