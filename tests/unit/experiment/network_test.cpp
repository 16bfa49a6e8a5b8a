// The simulated network keeps TCP's contract and nothing more.
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
