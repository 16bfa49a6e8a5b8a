// A gateway that keeps dying is given up in the end.
#include "server/play/restart_limit.h"
#include "tests/support/catch.h"

TEST_CASE("the sixth restart within a minute is refused, and allowed again when the first is old") {
  aureole::RestartLimit limit(5, 60'000);
  for (int i = 0; i < 5; ++i) REQUIRE(limit.allow(1000 * i));
  REQUIRE_FALSE(limit.allow(59'999));
  REQUIRE(limit.allow(60'000));
  REQUIRE_FALSE(limit.allow(60'001));
}
