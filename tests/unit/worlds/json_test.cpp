// The JSON reader against hostile text.
#include <string>

#include "server/worlds/reading/json_reader.h"
#include "tests/support/catch.h"
#include "tests/unit/worlds/small_world.h"

namespace aureole {

TEST_CASE("nesting is bounded before anything is built") {
  const std::string bombs[] = {std::string(1'000'000, '['), [] {
                                 std::string s;
                                 for (int i = 0; i < 100'000; ++i) s += "{\"a\":";
                                 return s;
                               }()};
  for (const std::string& text : bombs) {
    const auto document = JsonDocument::parse(text, "w");
    REQUIRE_FALSE(document);
    CHECK(document.error().message.find("found more than 16 levels of nesting") !=
          std::string::npos);
  }
  CHECK(JsonDocument::parse(std::string(16, '[') + std::string(16, ']'), "w"));
  CHECK_FALSE(JsonDocument::parse(std::string(17, '[') + std::string(17, ']'), "w"));
}

TEST_CASE(
    "a world file cut off anywhere, or with any byte changed, is refused or read, and never ends "
    "the process") {
  const std::string& text = test::small_world;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    CHECK_FALSE(parse_world(text.substr(0, i), "w"));
    for (char c : {'\0', '"', '{', ']', '-', '9', 'e', '\xff'}) {
      std::string changed = text;
      changed[i] = c;
      const auto world = parse_world(changed, "w");
      if (!world) CHECK(world.error().message.starts_with("w: "));
    }
  }
}

TEST_CASE("the path of a doubled key counts the elements before it") {
  const auto document = JsonDocument::parse(R"({ "a/b": [ 1, [ 2 ], { "x": 1, "x": 2 } ] })", "w");
  REQUIRE_FALSE(document);
  CHECK(document.error().message == "w: /a~1b/2/x: the key is there twice, expected once");
}

TEST_CASE("a likely meaning is one that is close, or lacks only its unit") {
  CHECK(likely_meant("radus", {"height", "radius"}) == "radius");
  CHECK(likely_meant("latency", {"latency_ms", "speed_mps"}) == "latency_ms");
  CHECK_FALSE(likely_meant("elephant", {"height", "radius"}));
}

}  // namespace aureole
