// Who keeps a line, what it counts, and how its line goes where it had better lie.
#include "server/region/lines/line_keeper.h"

#include <limits>
#include <vector>

#include "tests/support/catch.h"
#include "tests/unit/region/lines/crowds.h"

using namespace aureole;
using testing::put;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Three regions in a row, 150 m each.
PartitionMap row() {
  return PartitionMap({{-inf, -inf, -75, inf}, {-75, -inf, 75, inf}, {75, -inf, inf, inf}});
}

std::vector<NewBody> awake_at(double x, int bodies) {
  std::vector<NewBody> awake(static_cast<std::size_t>(bodies));
  for (NewBody& body : awake) body.state.position = {x, 1, 0};
  return awake;
}

}  // namespace

TEST_CASE(
    "who is awake is counted by its distance from the line, and forgotten when it is far off") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{1});
  REQUIRE(keeper.line());
  CHECK(keeper.keeper_below_of(RegionId{1}) == RegionId{0});
  for (int i = 0; i < 100; ++i) keeper.note_awake(awake_at(-75 + 3, 10));
  CHECK(keeper.crowd_below().between(0, 4) == Approx(10));
  CHECK(keeper.crowd_below().between(-56, 56) == Approx(10));
  for (int i = 0; i < 400; ++i) keeper.note_awake(awake_at(-75 + 57, 10));
  CHECK(keeper.crowd_below().between(-56, 56) == Approx(0).margin(1e-6));
}

TEST_CASE("the last server of a row keeps no line, the first one has nobody below it") {
  LineKeeper last(PartitionLines(row()), 3, RegionId{2}),
      first(PartitionLines(row()), 3, RegionId{0});
  CHECK_FALSE(last.line());
  CHECK(last.keeper_below_of(RegionId{2}) == RegionId{1});
  CHECK(last.next_m(5) == 5);
  CHECK(first.line());
  CHECK_FALSE(first.keeper_below_of(RegionId{0}));
}

TEST_CASE("a line sets out, step by step, and what it will bring is told until it is there") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
  keeper.look_from(10, {.crowd_share = 1});
  for (int i = 0; i < 200; ++i) {
    keeper.note_awake(awake_at(-75 - 2, 20));
    keeper.hear(RegionId{0}, 40, 0, {});
    Crowd theirs;
    put(theirs, 0, 20);
    keeper.hear(RegionId{1}, 60, 0, theirs);
    keeper.hear(RegionId{2}, 80, 0, {});
  }
  CHECK(keeper.next_m(0) == LineKeeper::step_m);
  CHECK(keeper.gain() == 20);
  CHECK(keeper.next_m(9) == 12);
  CHECK(keeper.next_m(12) == 12);
}

TEST_CASE("what other lines will bring counts before they are there") {
  const auto next_m = [](std::int32_t brings) {
    LineKeeper keeper(PartitionLines(row()), 3, RegionId{1});
    keeper.look_from(10, {.crowd_share = 1});
    for (int i = 0; i < 200; ++i) {
      keeper.note_awake(awake_at(75 - 2, 20));
      Crowd theirs;
      put(theirs, 0, 20);
      keeper.hear(RegionId{0}, 100, brings, {});
      keeper.hear(RegionId{1}, 100, 0, {});
      keeper.hear(RegionId{2}, 100, 0, theirs);
    }
    return keeper.next_m(0);
  };
  CHECK(next_m(0) == 0);    // 120 on either side would be too much …
  CHECK(next_m(10) == 12);  // … unless the line below takes some of it, …
  CHECK(next_m(-10) == 0);  // … or brings more.
}

TEST_CASE("a line does not set out once hardly anything is awake, however much was") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
  keeper.look_from(10, {.crowd_share = 1});
  for (int i = 0; i < 200; ++i) {
    keeper.note_awake(awake_at(-75 - 2, 20));
    for (std::uint16_t k = 0; k < 3; ++k) keeper.hear(RegionId{k}, 50, 0, {});
  }
  CHECK_FALSE(keeper.idle());
  for (std::uint16_t k = 0; k < 3; ++k) keeper.hear(RegionId{k}, 9, 0, {});
  CHECK(keeper.idle());
  CHECK(keeper.next_m(0) == 0);
  keeper.hear(RegionId{1}, 50, 0, {});
  CHECK_FALSE(keeper.idle());
  CHECK(keeper.next_m(0) != 0);
}

TEST_CASE(
    "a line that was on its way stays where it is when all calms down, and looks again then") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
  keeper.look_from(10, {.crowd_share = 1});
  const auto look = [&](double crowd_m, int times) {
    for (int i = 0; i < times; ++i) {
      keeper.note_awake(awake_at(-75 - 2, 20));
      Crowd theirs;
      put(theirs, crowd_m, 20);
      keeper.hear(RegionId{0}, 40, 0, {});
      keeper.hear(RegionId{1}, 60, 0, theirs);
      keeper.hear(RegionId{2}, 80, 0, {});
    }
  };
  look(0, 200);
  REQUIRE(keeper.next_m(0) == 12);
  REQUIRE(keeper.gain() == 20);
  keeper.note_awake({});
  for (std::uint16_t k = 0; k < 3; ++k) keeper.hear(RegionId{k}, 0, 0, {});
  CHECK(keeper.next_m(4) == 4);
  CHECK(keeper.gain() == 0);
  // Where it was going there is a crowd by now.
  look(12, 200);
  CHECK(keeper.next_m(4) != 12);
}

TEST_CASE("nothing moves while hardly anything is awake anywhere") {
  for (const double enough : {49.0, 51.0}) {
    LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
    keeper.look_from(enough, {.crowd_share = 1});
    for (int i = 0; i < 200; ++i) {
      keeper.note_awake(awake_at(-75 - 2, 20));
      for (std::uint16_t k = 0; k < 3; ++k) keeper.hear(RegionId{k}, 50, 0, {});
    }
    CHECK((keeper.next_m(0) == 0) == (enough > 50));
  }
}
