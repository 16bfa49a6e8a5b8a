// How many pictures, how large, and of which moment.
#include <algorithm>
#include <cstdlib>
#include <deque>

#include "server/gateway/pictures/draw_clock.h"
#include "server/gateway/pictures/picture_pacing.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// A browser at the end of a line: pictures take `one_way_us` there and back, and are decoded one
/// after the other, `decode_us` each (for full size and best quality; less for less).
struct ModelBrowser {
  std::int64_t one_way_us;
  std::int64_t decode_us;
  PicturePacing pacing;
  std::int64_t now_us = 1'000'000;
  std::int64_t decoder_free_us = 0;
  std::uint32_t number = 0;
  int sent = 0;
  struct Ack {
    std::int64_t at_us;
    std::uint32_t number;
  };
  std::deque<Ack> acks{};

  void run(double seconds) {
    const std::int64_t end = now_us + static_cast<std::int64_t>(seconds * 1e6);
    for (; now_us < end; now_us += PicturePacing::interval_us) {
      while (!acks.empty() && acks.front().at_us <= now_us) {
        pacing.acknowledged(acks.front().number, acks.front().at_us);
        acks.pop_front();
      }
      pacing.tick(now_us);
      if (!pacing.has_room()) {
        pacing.held_back();
        continue;
      }
      pacing.sent(++number, now_us);
      ++sent;
      const double cost = pacing.scale() * pacing.scale() * (0.5 + pacing.quality() / 180.0);
      decoder_free_us = std::max(decoder_free_us, now_us + one_way_us) +
                        static_cast<std::int64_t>(static_cast<double>(decode_us) * cost);
      acks.push_back({decoder_free_us + one_way_us, number});
    }
  }
};

}  // namespace

TEST_CASE("A fast browser gets every picture in the best quality and full size") {
  ModelBrowser browser{500, 4'000, {}};
  browser.run(30);
  REQUIRE(browser.sent >= 29 * 60);
  REQUIRE(browser.pacing.quality() == PicturePacing::quality_max);
  REQUIRE(browser.pacing.scale() == 1.0);
  REQUIRE(browser.pacing.window() == PicturePacing::window_min);
}

TEST_CASE("A browser far away gets every picture too, through a wider window") {
  ModelBrowser browser{50'000, 2'000, {}};
  browser.run(10);
  browser.sent = 0;
  browser.run(10);
  REQUIRE(browser.sent >= 590);
  REQUIRE(browser.pacing.window() >= 8);
  REQUIRE(browser.pacing.window() <= PicturePacing::window_max);
}

TEST_CASE("A slow browser gets smaller pictures rather than a slide show, and none queue up") {
  ModelBrowser browser{500, 120'000, {}};
  browser.run(20);
  REQUIRE(browser.pacing.scale() == 0.5);
  REQUIRE(browser.pacing.quality() == PicturePacing::quality_min);
  REQUIRE(browser.pacing.in_flight() <= browser.pacing.window());
  browser.sent = 0;
  browser.run(10);
  REQUIRE(browser.sent >= 250);  // at full size it could take 8 a second
}

TEST_CASE("A browser that becomes fast again gets the full size back") {
  ModelBrowser browser{500, 120'000, {}};
  browser.run(20);
  REQUIRE(browser.pacing.scale() < 1.0);
  browser.decode_us = 3'000;
  browser.run(120);
  REQUIRE(browser.pacing.scale() == 1.0);
  REQUIRE(browser.pacing.quality() > PicturePacing::quality_start);
}

TEST_CASE("A browser that never acknowledges gets one window of pictures and no more") {
  PicturePacing pacing;
  std::uint32_t number = 0;
  for (std::int64_t now = 1; now < 60'000'000; now += PicturePacing::interval_us) {
    pacing.tick(now);
    if (pacing.has_room())
      pacing.sent(++number, now);
    else
      pacing.held_back();
  }
  REQUIRE(number == static_cast<std::uint32_t>(PicturePacing::window_min));
  pacing.acknowledged(number, 60'000'000);  // it had skipped the older ones
  REQUIRE(pacing.in_flight() == 0);
}

TEST_CASE(
    "Acknowledgements of pictures that were never sent change nothing but what is behind them") {
  PicturePacing pacing;
  pacing.sent(5, 1'000);
  pacing.acknowledged(4, 2'000);
  REQUIRE(pacing.in_flight() == 1);
  REQUIRE(pacing.shortest_round_trip_us() == 0);
  pacing.acknowledged(5, 3'000);
  REQUIRE(pacing.shortest_round_trip_us() == 2'000);
}

TEST_CASE("Drawn time is a tick and a quarter behind, and runs evenly through jitter") {
  DrawClock clock;
  std::int64_t last = 0;
  unsigned noise = 1;
  for (int tick = 100; tick < 1'000; ++tick) {
    noise = noise * 1664525u + 1013904223u;
    const std::int64_t jitter = noise >> 21;  // 0 … 2 ms
    const std::int64_t local = 5'000'000 + tick * tick_us + jitter;
    clock.arrived(RegionId{0}, Tick{tick}, local);
    const auto world = clock.world_us(5'000'000 + tick * tick_us + 3'000);
    REQUIRE(world);
    if (tick > 300) REQUIRE(std::abs(*world - last - tick_us) <= 200);
    last = *world;
  }
  const std::int64_t newest = 999 * tick_us;
  REQUIRE(newest - last >= DrawClock::reserve_us - 3'000);
  REQUIRE(newest - last <= DrawClock::reserve_us);
}

TEST_CASE("Drawing waits for the slowest region, and no longer once it is gone") {
  DrawClock clock;
  std::int64_t now = 0;
  const auto run = [&](int ticks, bool slow_too) {
    for (int i = 0; i < ticks; ++i, now += tick_us) {
      clock.arrived(RegionId{0}, Tick{now / tick_us}, now);
      if (slow_too) clock.arrived(RegionId{1}, Tick{now / tick_us}, now + 40'000);
      (void)clock.world_us(now);
    }
  };
  run(500, true);
  REQUIRE(now - *clock.world_us(now) == Approx(DrawClock::reserve_us + 40'000).margin(500));
  clock.forget(RegionId{1});
  run(500, false);
  REQUIRE(now - *clock.world_us(now) == Approx(DrawClock::reserve_us).margin(500));
}

TEST_CASE("Drawn time never goes back, stands still without regions, and follows a new world") {
  DrawClock clock;
  REQUIRE_FALSE(clock.world_us(1'000'000));
  clock.arrived(RegionId{0}, Tick{1'000}, 16'000'000);
  const std::int64_t before = *clock.world_us(16'000'000);
  clock.arrived(RegionId{1}, Tick{1'000}, 16'100'000);  // a region that lags by 100 ms comes up
  REQUIRE(*clock.world_us(16'000'500) >= before);
  clock.forget(RegionId{0});
  clock.forget(RegionId{1});
  const std::int64_t still = *clock.world_us(16'200'000);
  REQUIRE(*clock.world_us(18'000'000) == still);
  clock.arrived(RegionId{0}, Tick{10}, 19'000'000);  // the world was started anew
  REQUIRE(*clock.world_us(19'000'000) == 10 * tick_us - DrawClock::reserve_us);
}
