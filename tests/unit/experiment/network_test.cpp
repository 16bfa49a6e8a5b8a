// The simulated network keeps TCP's contract and nothing more.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/experiment/network/simulated_network.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr Micros ms = 1000;

SharedBytes numbered(std::uint8_t n) {
  return std::make_shared<const Bytes>(Bytes{std::byte{n}});
}

/// Two ends and an unmeasured third one, linked from the beginning.
struct Pair {
  explicit Pair(NetworkTiming timing = {2 * ms, 1 * ms}) : network(3, timing, 7) {
    for (End end = 0; end < 3; ++end) network.start(end, Incarnation{1}, 0);
    for (End end = 0; end < 3; ++end) {
      network.advance(0);
      network.take(end, 0);
    }
  }
  /// Everything that reaches `to` up to `until`, looked for every millisecond.
  std::vector<Delivery> watch(End to, Micros from, Micros until) {
    std::vector<Delivery> all;
    for (Micros at = from; at <= until; at += ms) {
      network.advance(at);
      for (Delivery& d : network.take(to, at)) all.push_back(std::move(d));
    }
    return all;
  }
  SimulatedNetwork network;
};

std::vector<int> numbers(const std::vector<Delivery>& deliveries) {
  std::vector<int> all;
  for (const Delivery& d : deliveries)
    if (d.kind == Delivery::Kind::frame) all.push_back(std::to_integer<int>(d.frame->front()));
  return all;
}

std::vector<Delivery::Kind> kinds(const std::vector<Delivery>& deliveries) {
  std::vector<Delivery::Kind> all;
  for (const Delivery& d : deliveries)
    if (d.kind != Delivery::Kind::measured) all.push_back(d.kind);
  return all;
}

}  // namespace

TEST_CASE("frames arrive in order, all of them, after their latency at the latest") {
  Pair pair;
  for (std::uint8_t n = 0; n < 50; ++n) pair.network.send(0, 1, numbered(n), n * 100);
  REQUIRE(numbers(pair.network.take(1, 900)).empty());
  const auto got = numbers(pair.watch(1, ms, 7 * ms));
  REQUIRE(got.size() == 50);
  REQUIRE(std::is_sorted(got.begin(), got.end()));
}

TEST_CASE("a stalled channel holds everything back and then delivers it; the other way flows") {
  Pair pair;
  pair.network.stall(0, 1, 300 * ms);
  pair.network.send(0, 1, numbered(1), 10 * ms);
  pair.network.send(1, 0, numbered(2), 10 * ms);
  REQUIRE(pair.network.is_disturbed(0, 1, 20 * ms, 2 * ms));
  REQUIRE(numbers(pair.watch(1, 10 * ms, 299 * ms)).empty());
  REQUIRE(numbers(pair.network.take(0, 20 * ms)) == std::vector{2});
  REQUIRE(numbers(pair.network.take(1, 300 * ms)) == std::vector{1});
}

TEST_CASE(
    "a reset loses what is in flight both ways, and both ends learn of it before the new link") {
  Pair pair;
  pair.network.send(0, 1, numbered(1), 10 * ms);
  pair.network.send(1, 0, numbered(2), 10 * ms);
  pair.network.reset(0, 1, 10 * ms, 50 * ms);
  // Neither has noticed yet: what it sends goes nowhere.
  pair.network.send(0, 1, numbered(3), 10 * ms + 1);
  const std::vector expected{Delivery::Kind::down, Delivery::Kind::up};
  REQUIRE(kinds(pair.watch(0, 10 * ms, 200 * ms)) == expected);
  REQUIRE(kinds(pair.watch(1, 10 * ms, 200 * ms)) == expected);
  REQUIRE(pair.network.frames_lost() == 3);
  pair.network.send(0, 1, numbered(4), 200 * ms);
  REQUIRE(numbers(pair.watch(1, 200 * ms, 210 * ms)) == std::vector{4});
}

TEST_CASE("a killed process is missed by the others, and comes back with its new incarnation") {
  Pair pair;
  pair.network.send(0, 1, numbered(1), 10 * ms);
  pair.network.kill(1, 10 * ms);
  REQUIRE(kinds(pair.watch(0, 10 * ms, 100 * ms)) == std::vector{Delivery::Kind::down});
  pair.network.start(1, Incarnation{2}, 500 * ms);
  const auto mine = pair.watch(1, 500 * ms, 700 * ms);
  REQUIRE(kinds(mine) == std::vector{Delivery::Kind::up, Delivery::Kind::up});
  const auto others = pair.watch(0, 500 * ms, 700 * ms);
  REQUIRE(kinds(others) == std::vector{Delivery::Kind::up});
  REQUIRE(others.front().incarnation == Incarnation{2});
}

TEST_CASE("a ping measures the latency, and the time that a stall held it") {
  Pair pair({2 * ms, 0});
  const auto measured = [&](Micros from, Micros until) {
    std::vector<double> all;
    for (const Delivery& d : pair.watch(0, from, until))
      if (d.kind == Delivery::Kind::measured && d.from == 1) all.push_back(d.latency_ms);
    return all;
  };
  const auto calm = measured(ms, 1000 * ms);
  REQUIRE(calm.size() >= 3);
  REQUIRE(calm.size() <= 5);
  for (const double latency_ms : calm) REQUIRE(latency_ms == Approx(2).margin(0.01));
  pair.network.stall(0, 1, 1400 * ms);
  const auto held = measured(1001 * ms, 1500 * ms);
  REQUIRE_FALSE(held.empty());
  REQUIRE(held.front() > 20);
}

TEST_CASE("a lost segment holds up what comes after it until it has been sent again, in order") {
  // Nothing gets through at once: everything waits for a retransmission or for one before it.
  Pair lossy({2 * ms, 0, 0.3});
  std::vector<Delivery> all;
  constexpr int frames = 200;
  for (int n = 0; n < frames; ++n) {
    const Micros at = (n + 1) * 16 * ms;
    lossy.network.send(0, 1, numbered(static_cast<std::uint8_t>(n)), at);
    for (Delivery& d : lossy.watch(1, at, at + 15 * ms)) all.push_back(std::move(d));
  }
  for (Delivery& d : lossy.watch(1, (frames + 1) * 16 * ms, 30'000 * ms))
    all.push_back(std::move(d));
  std::vector<int> expected;
  for (int n = 0; n < frames; ++n) expected.push_back(n);
  REQUIRE(numbers(all) == expected);
  REQUIRE(lossy.network.frames_sent_again() == Approx(frames * 0.3).margin(20));
}

namespace {

/// Looks for a run in which exactly the first frame is lost, and says how long it took.
Micros took_us(bool followed, Micros latency_us) {
  for (std::uint64_t seed = 1; seed < 200; ++seed) {
    SimulatedNetwork network(3, {latency_us, 0, 0.2}, seed);
    for (End end = 0; end < 2; ++end) network.start(end, Incarnation{1}, 0);
    for (End end = 0; end < 2; ++end) network.take(end, 0);
    network.send(0, 1, numbered(1), 0);
    const bool lost = network.frames_sent_again() == 1;
    if (followed) network.send(0, 1, numbered(2), 16 * ms);
    if (!lost || network.frames_sent_again() != 1) continue;
    for (Micros at = 0; at < 2000 * ms; at += ms / 2) {
      const auto got = network.take(1, at);
      if (got.empty()) continue;
      // What came after it has waited for it.
      REQUIRE(got.size() == (followed ? 2 : 1));
      REQUIRE(network.is_disturbed(0, 1, at, latency_us));
      if (got.front().arrived_us < 400 * ms) return got.front().arrived_us;
      break;  // Lost twice.
    }
  }
  return -1;
}

}  // namespace

TEST_CASE("what is followed is sent again 5/4 round trips later, what is not by the timer") {
  CHECK(took_us(true, 2 * ms) == 16 * ms + 5 * ms + 2 * ms);
  CHECK(took_us(false, 2 * ms) == 204 * ms + 2 * ms);
  CHECK(took_us(true, 40 * ms) == 16 * ms + 100 * ms + 40 * ms);
  CHECK(took_us(false, 40 * ms) == 280 * ms + 40 * ms);
}

TEST_CASE("a frame of many segments is lost more often, and knows of it by its own last one") {
  PacketLoss loss(0.01, 4 * ms, 3);
  int small = 0, large = 0, noticed = 0;
  for (int n = 0; n < 4000; ++n) {
    small += loss.draw(PacketLoss::segment_bytes).lost ? 1 : 0;
    const PacketLoss::Fate fate = loss.draw(20 * PacketLoss::segment_bytes);
    large += fate.lost ? 1 : 0;
    noticed += fate.lost && !fate.last_lost ? 1 : 0;
  }
  CHECK(small == Approx(40).margin(20));
  CHECK(large == Approx(4000 * (1 - std::pow(0.99, 20))).margin(80));
  CHECK(noticed == Approx(large * 19 / 20.0).margin(60));
}

TEST_CASE("without loss nothing is different from a network that knows none") {
  Pair with({2 * ms, 1 * ms, 0.0}), without({2 * ms, 1 * ms});
  for (std::uint8_t n = 0; n < 100; ++n) {
    const Micros at = (n + 1) * ms;
    with.network.send(0, 1, numbered(n), at);
    without.network.send(0, 1, numbered(n), at);
    const auto a = with.watch(1, at, at), b = without.watch(1, at, at);
    REQUIRE(numbers(a) == numbers(b));
  }
}

TEST_CASE("a ping waits behind what was lost, so that stalls are measured") {
  Pair lossy({2 * ms, 0, 0.05});
  double longest_ms = 0;
  std::vector<double> all;
  for (Micros at = ms; at < 60'000 * ms; at += ms) {
    if (at % (16 * ms) == 0) {
      lossy.network.send(0, 1, numbered(1), at);
      lossy.network.send(1, 0, numbered(1), at);
    }
    lossy.network.advance(at);
    lossy.network.take(1, at);
    for (const Delivery& d : lossy.network.take(0, at))
      if (d.kind == Delivery::Kind::measured && d.from == 1) all.push_back(d.latency_ms);
  }
  for (const double latency_ms : all) longest_ms = std::max(longest_ms, latency_ms);
  REQUIRE(all.size() > 200);
  CHECK(longest_ms > 5);
  CHECK(*std::min_element(all.begin(), all.end()) == Approx(2).margin(0.6));
}
