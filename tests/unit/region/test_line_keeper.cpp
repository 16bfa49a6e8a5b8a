// Where a line had better lie, by who is awake near it and how much everybody has to do.
#include "server/region/loads/line_keeper.h"

#include <limits>
#include <vector>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Bodies in one bin, by where it begins.
void put(Crowd& crowd, double from_m, double bodies) {
  crowd.awake[static_cast<std::size_t>((from_m - Crowd::from_m) / Crowd::bin_m)] += bodies;
}

/// Twenty servers with 100 bodies awake each; between two of them a crowd of 40 around their line,
/// from 20 m below it to 20 m above, and hardly anybody else.
LineSituation crowded() {
  LineSituation line;
  line.far_m = 45;
  for (double at = -20; at < 20; at += Crowd::bin_m)
    put(at < 0 ? line.below_has : line.above_has, at, 4);
  line.below = line.above = line.mean = 100;
  line.all = 2000;
  return line;
}

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
    "a line leaves a crowd for where hardly anything stirs, on the side that has less to do") {
  LineSituation line = crowded();
  line.below = 80;  // It gets the other half.
  CHECK(quiet_place_m(line) == 28);
  std::swap(line.below, line.above);
  CHECK(quiet_place_m(line) == -28);
}

TEST_CASE("neither side may have much more than all servers' mean when a line has moved") {
  LineSituation line = crowded();
  line.below = 96;
  line.above = 120;
  CHECK(quiet_place_m(line) == 0);  // 116 or 140 of 115.
  line.below = 94;
  CHECK(quiet_place_m(line) == 28);
}

TEST_CASE("a crowd that is much of what the world has awake is shared where it lies") {
  LineSituation line = crowded();
  line.below = 80;
  line.all = 499;  // Of which 40 are more than 8 %.
  CHECK(quiet_place_m(line) == 0);
  line.all = 501;
  CHECK(quiet_place_m(line) == 28);
}

TEST_CASE("a handful is not worth the way, nor a place where half as many stir") {
  LineSituation few;
  few.far_m = 45;
  few.below = 80;
  few.above = few.mean = 100;
  few.all = 2000;
  put(few.below_has, -4, 4);
  put(few.above_has, 0, 3.9);
  CHECK(quiet_place_m(few) == 0);
  put(few.above_has, 0, 0.2);
  CHECK(quiet_place_m(few) != 0);
  LineSituation everywhere = crowded();
  everywhere.below = 80;
  everywhere.all = 1e6;
  for (double at = -56; at < 56; at += Crowd::bin_m)
    if (at < -20 || at >= 20) put(everywhere.below_has, at, 2.1);
  CHECK(quiet_place_m(everywhere) == 0);
}

TEST_CASE("a line goes no further than it may") {
  LineSituation line = crowded();
  line.below = 80;
  line.far_m = 26;  // 8 m to either side reach into the crowd there, but to less than half of it.
  CHECK(quiet_place_m(line) == 24);
  line.far_m = 10;
  CHECK(quiet_place_m(line) == 0);
}

TEST_CASE("who has far too much because of its line is rid of it") {
  LineSituation line = crowded();
  line.here_m = 28;
  line.below = 131;
  CHECK(quiet_place_m(line) == 0);
  line.below = 129;
  CHECK(quiet_place_m(line) == 28);
  line.here_m = -28;
  line.above = 131;
  CHECK(quiet_place_m(line) == 0);
}

TEST_CASE("what a line will bring counts who is hosted across it, wherever that lies") {
  const LineSituation line = crowded();
  CHECK(line.gain(0) == 0);
  CHECK(line.gain(28) == 20);
  CHECK(line.gain(-28) == -20);
  CHECK(line.gain(8) == 8);
  LineSituation abroad = crowded();
  put(abroad.above_has, -12, 5);  // Will go home as soon as it can.
  CHECK(abroad.gain(0) == 5);
}

TEST_CASE("a crowd travels as a byte for each bin, nearly as it is") {
  Crowd crowd;
  put(crowd, -56, 0.5);
  put(crowd, 0, 37);
  put(crowd, 52, 12'345);
  const std::vector<std::uint8_t> bytes = crowd.encoded();
  REQUIRE(bytes.size() == 28);
  const auto read = Crowd::decoded(bytes);
  REQUIRE(read);
  for (std::size_t i = 0; i < crowd.awake.size(); ++i)
    CHECK(read->awake[i] == Approx(crowd.awake[i]).epsilon(0.026).margin(0.04));
  put(crowd, 8, 1e12);  // More than there can be: as many as a byte can say.
  CHECK(Crowd::decoded(crowd.encoded())->awake[16] == Approx(std::expm1(255 * std::log(1.05))));
}

TEST_CASE("a crowd of another size is refused, with what was expected") {
  for (const std::size_t size : {std::size_t{0}, std::size_t{27}, std::size_t{29}}) {
    const auto read = Crowd::decoded(std::vector<std::uint8_t>(size, 1));
    REQUIRE_FALSE(read);
    CHECK(read.error().message == "a crowd of " + std::to_string(size) + " bins; expected 28");
  }
}

TEST_CASE(
    "who is awake is counted by its distance from the line, less for others, nothing far off") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{1});
  REQUIRE(keeper.line());
  CHECK(keeper.keeper_below() == RegionId{0});
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
  CHECK(last.keeper_below() == RegionId{1});
  CHECK(last.next_m(5) == 5);
  CHECK(first.line());
  CHECK_FALSE(first.keeper_below());
}

TEST_CASE("a line sets out, step by step, and what it will bring is told until it is there") {
  LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
  keeper.look_from(10, true);
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
    keeper.look_from(10, true);
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

TEST_CASE("nothing moves while hardly anything is awake anywhere") {
  for (const double enough : {49.0, 51.0}) {
    LineKeeper keeper(PartitionLines(row()), 3, RegionId{0});
    keeper.look_from(enough, true);
    for (int i = 0; i < 200; ++i) {
      keeper.note_awake(awake_at(-75 - 2, 20));
      for (std::uint16_t k = 0; k < 3; ++k) keeper.hear(RegionId{k}, 50, 0, {});
    }
    CHECK((keeper.next_m(0) == 0) == (enough > 50));
  }
}
