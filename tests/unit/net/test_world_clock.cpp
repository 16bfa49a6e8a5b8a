// World time learnt over links: exact on even trips, steady on uneven ones, never backwards in
// leaps.
#include <random>

#include "server/net/world_clock.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("the reference's time is local time plus what it began with") {
  WorldClock clock;
  REQUIRE_FALSE(clock.world_us(5));
  clock.start_as_reference(1'000, 0);
  REQUIRE(clock.world_us(17'000) == 16'000);
  REQUIRE(clock.local_us(16'000) == 17'000);
}

TEST_CASE("one even round trip sets a follower's clock exactly") {
  WorldClock clock;
  // World = local + 500,000. Asked at 1000, answered at 1200, heard at 1400.
  clock.add_sample(1'000, 501'200, 1'400);
  REQUIRE(clock.world_us(2'000) == 502'000);
  REQUIRE(clock.round_trip_us() == 400);
}

TEST_CASE("uneven and slow trips do not move a clock that had a good one") {
  WorldClock clock;
  clock.add_sample(1'000, 501'100, 1'200);
  std::mt19937 random(3);
  std::int64_t now = 2'000;
  for (int i = 0; i < 15; ++i) {
    const std::int64_t there = 100 + random() % 20'000, back = 100 + random() % 300;
    clock.add_sample(now, now + there + 500'000, now + there + back);
    now += 250'000;
  }
  REQUIRE(std::abs(*clock.world_us(now) - (now + 500'000)) < 100);
}

TEST_CASE("a drifting clock is followed slowly, a wrong one at once") {
  WorldClock clock;
  clock.add_sample(0, 500'100, 200);
  std::int64_t before = *clock.world_us(200);
  // The reference is 10 ms ahead of what we think: made up at 1 % at most.
  for (std::int64_t now = 100'000; now < 3'000'000; now += 100'000) {
    clock.add_sample(now, now + 510'050, now + 100);
    const std::int64_t after = *clock.world_us(now + 100);
    REQUIRE(after - before <= 100'000 + 1'000 + 1);
    REQUIRE(after >= before);
    before = after;
  }
  REQUIRE(std::abs(*clock.world_us(3'000'000) - 3'510'000) < 200);
  for (std::int64_t now = 4'000'000; now < 4'200'000; now += 10'000)
    clock.add_sample(now, now + 9'000'050, now + 100);
  REQUIRE(std::abs(*clock.world_us(4'200'000) - 13'200'000) < 200);
}

TEST_CASE("a follower that becomes the reference goes on with its time") {
  WorldClock clock;
  clock.add_sample(0, 500'100, 200);
  const auto before = *clock.world_us(1'000);
  clock.start_as_reference(1'000, 0);
  REQUIRE(clock.world_us(1'000) == before);
  clock.add_sample(1'000, 9'000'000, 1'200);
  REQUIRE(clock.world_us(1'000) == before);
}
