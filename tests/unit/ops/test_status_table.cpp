// The status of a world, from the gateway's JSON to a table.
#include "server/ops/status_table.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {
const std::string two_regions = R"({"world_time_s": 12.34, "bodies": 7, "players": 1, "newer": [],
  "regions": [
    {"name": "north", "up": true, "bodies": 4, "awake": 2, "frame_ms_p50": 1.25,
     "frame_ms_max": 9.5, "migrations_in": 3, "migrations_out": 1},
    {"name": "south\u001b[2J", "up": false, "bodies": 3, "awake": 0, "frame_ms_p50": 0,
     "frame_ms_max": 0, "migrations_in": 1, "migrations_out": 3}]})";
}

TEST_CASE("a table shows the world, then one line for each region") {
  const auto status = parse_world_status(two_regions);
  REQUIRE(status);
  REQUIRE_FALSE(all_up(*status));
  REQUIRE(status_table(*status) ==
          "world time 12.3 s, 7 bodies, 1 players\n"
          "region                  bodies    awake    p50 ms    max ms   came in  went out\n"
          "north      up                4        2      1.25      9.50         3         1\n"
          "south?[2J  DOWN              3        0      0.00      0.00         1         3\n");
}

TEST_CASE("a region that recovers is there, but not up") {
  std::string text = two_regions;
  text.replace(text.find("\"up\": false"), 11, "\"up\": true, \"recovering\": true");
  const auto status = parse_world_status(text);
  REQUIRE(status);
  REQUIRE_FALSE(all_up(*status));
  REQUIRE(status_table(*status).find("RECOVERING  ") != std::string::npos);
}

TEST_CASE("a tolerance that is not kept is named with its region, its peer and its tick") {
  std::string marked = two_regions;
  const std::string last = R"("migrations_out": 1)";
  marked.replace(marked.find("\"up\": false"), 11, "\"up\": true");
  marked.replace(marked.find("south\\u001b[2J"), 14, "south");
  marked.replace(marked.find(last), last.size(), last + R"(, "missed_blows": 3, "outside": [
    {"tolerance": "latency", "peer": "south", "since_tick": 625, "value": 5.25, "limit": 2, "unit": "ms"},
    {"tolerance": "link", "peer": "south", "since_tick": 626, "value": 12, "limit": 4, "unit": "ticks without word"},
    {"tolerance": "speed", "peer": null, "since_tick": 630, "value": 40, "limit": 32, "unit": "m/s"}])");
  const auto status = parse_world_status(marked);
  REQUIRE(status);
  const std::string table = status_table(*status);
  REQUIRE(table.ends_with(
      "! north is outside its latency tolerance towards south since tick 625: 5.2 ms, at most 2\n"
      "! north is outside its link tolerance towards south since tick 626: 12 ticks without word, "
      "at "
      "most 4\n"
      "! north is outside its speed tolerance since tick 630: 40.0 m/s, at most 32\n"
      "! north has missed 3 blows on other regions' resting bodies since its start\n"));
}

TEST_CASE("links towards a region that is down have no lines beside its own") {
  std::string marked = two_regions;
  const std::string last = R"("migrations_out": 1)";
  marked.replace(marked.find(last), last.size(), last + R"(, "outside": [
    {"tolerance": "latency", "peer": "south\u001b[2J", "since_tick": 625, "value": 5, "limit": 2, "unit": "ms"},
    {"tolerance": "link", "peer": "south\u001b[2J", "since_tick": 626, "value": 900, "limit": 4, "unit": "ticks without word"},
    {"tolerance": "speed", "peer": null, "since_tick": 630, "value": 40, "limit": 32, "unit": "m/s"}])");
  const auto status = parse_world_status(marked);
  REQUIRE(status);
  const std::string table = status_table(*status);
  REQUIRE(table.find("DOWN") != std::string::npos);
  REQUIRE(table.find("towards") == std::string::npos);
  REQUIRE(table.ends_with(
      "! north is outside its speed tolerance since tick 630: 40.0 m/s, at most 32\n"));
}

TEST_CASE("a region is found by its name or by its number") {
  const auto status = parse_world_status(two_regions);
  REQUIRE(status);
  REQUIRE(find_region(*status, "north") == &status->regions[0]);
  REQUIRE(find_region(*status, "r1") == &status->regions[1]);
  REQUIRE(find_region(*status, "r2") == nullptr);
  REQUIRE(find_region(*status, "") == nullptr);
}

TEST_CASE("what is not a status is an error that says why") {
  REQUIRE_FALSE(parse_world_status("<html>"));
  REQUIRE_FALSE(parse_world_status("{}"));
  REQUIRE_FALSE(parse_world_status("[1]"));
  std::string wrong_kind = two_regions;
  wrong_kind.replace(wrong_kind.find("true"), 4, "\"up\"");
  REQUIRE_FALSE(parse_world_status(wrong_kind));
}
