// Median and maximum of the recent past, and overruns that are never forgotten.
#include "server/ops/frame_statistics.h"
#include "tests/support/catch.h"

using aureole::FrameStatistics;

TEST_CASE("before the first step, statistics are zero") {
  const FrameStatistics empty(16'000);
  REQUIRE(empty.p50_ms() == 0);
  REQUIRE(empty.max_ms() == 0);
  REQUIRE(empty.count() == 0);
}

TEST_CASE("the median is the lower of the two middle durations") {
  FrameStatistics s(16'000);
  for (const int us : {9000, 1000, 3000, 5000}) s.add(us);
  REQUIRE(s.p50_ms() == 3.0);
  s.add(4000);
  REQUIRE(s.p50_ms() == 4.0);
  REQUIRE(s.max_ms() == 9.0);
}

TEST_CASE("a step that takes exactly its budget is no overrun, a longer one is") {
  FrameStatistics s(16'000);
  s.add(16'000);
  REQUIRE(s.overruns() == 0);
  s.add(16'001);
  REQUIRE(s.overruns() == 1);
}

TEST_CASE("a slow step leaves the maximum after 512 others, but stays counted as an overrun") {
  FrameStatistics s(16'000);
  s.add(50'000);
  for (std::size_t i = 1; i < FrameStatistics::window; ++i) s.add(2000);
  REQUIRE(s.max_ms() == 50.0);
  s.add(2000);
  REQUIRE(s.max_ms() == 2.0);
  REQUIRE(s.p50_ms() == 2.0);
  REQUIRE(s.overruns() == 1);
  REQUIRE(s.count() == FrameStatistics::window + 1);
}
