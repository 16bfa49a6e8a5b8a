// What the log says about tolerances, and how often.
#include "server/net/tolerance_log.h"
#include "tests/support/catch.h"

using namespace aureole;
using Kind = ToleranceEvent::Kind;

namespace {

ToleranceEvent late(std::uint16_t peer, std::int64_t tick, bool outside = true) {
  return {Kind::latency, outside, Tick{tick}, RegionId{peer}, {}, 5.25, 2};
}

}  // namespace

TEST_CASE("a line names the tolerance, the tick, the peer, the value and the limit") {
  ToleranceLog log;
  REQUIRE(log.line(late(1, 625)) ==
          "outside its tolerance at tick 625, latency: messages of r1 take 5.2 ms; at most 2");
  // Bodies by the numbers that /api/replicas gives them.
  REQUIRE(log.line({Kind::speed, true, Tick{7}, {}, BodyId::world(3), 40, 32}) ==
          "outside its tolerance at tick 7, speed: body 72057594037927939 moves at 40.0 m/s; at "
          "most 32");
  REQUIRE(
      log.line({Kind::link, false, Tick{9}, RegionId{2}, {}, 1, 2}) ==
      "back inside its tolerance at tick 9, link: the newest word of r2 is 1 ticks old; at most 2");
  REQUIRE(log.line({Kind::link, true, Tick{9}, RegionId{2}, {}, 1, 2}) ==
          "outside its tolerance at tick 9, link: r2 is lost");
}

TEST_CASE("each kind and peer has one line a second, and says how many were left out") {
  ToleranceLog log;
  REQUIRE_FALSE(log.line(late(1, 1000)).empty());
  REQUIRE(log.line(late(1, 1020)).empty());
  REQUIRE(log.line(late(1, 1061)).empty());
  REQUIRE_FALSE(log.line(late(2, 1061)).empty());
  REQUIRE_FALSE(log.line(late(1, 1061, false)).empty());
  REQUIRE(log.line(late(1, 1062)).ends_with("(2 more times before that)"));
}

TEST_CASE("what is outside while a server begins is told a second later, if it still is") {
  ToleranceLog log;
  log.begin(Tick{1000});
  const auto told = [&](std::int64_t now, std::vector<ToleranceEvent> events) {
    return log.lines(Tick{now}, events);
  };
  CHECK(told(1001, {late(1, 1001), late(2, 1001)}).empty());
  CHECK(told(1030, {late(1, 1030, false)}).empty());
  CHECK(told(1061, {}).empty());
  const auto lines = told(1062, {late(3, 1062)});
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].outside);
  CHECK(lines[0].text.find("at tick 1001, latency: messages of r2") != std::string::npos);
  CHECK(lines[1].text.find("at tick 1062, latency: messages of r3") != std::string::npos);
  CHECK(told(1070, {late(1, 1070, false)}).size() == 1);
  // Without a beginning all is told at once.
  ToleranceLog other;
  const std::vector<ToleranceEvent> events{late(1, 5)};
  CHECK(other.lines(Tick{5}, events).size() == 1);
}
