// Where a line had better lie, by who is awake near it and how much everybody has to do.
#include "server/region/lines/quiet_place.h"

#include <utility>

#include "tests/support/catch.h"
#include "tests/unit/region/lines/crowds.h"

using namespace aureole;
using testing::put;

namespace {

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
  CHECK(quiet_place_m(line) == 8);
  line.all = 501;
  CHECK(quiet_place_m(line) == 28);
}

TEST_CASE("a line in a crowd that is shared goes to where both sides have as much to do") {
  LineSituation line = crowded();
  line.all = 499;
  line.below = 96;
  line.above = 104;  // Four bodies lie in each 4 m.
  CHECK(quiet_place_m(line) == 4);
  std::swap(line.below, line.above);
  CHECK(quiet_place_m(line) == -4);
  // What other lines bring counts, and so does what has moved already.
  line.here_m = -4;
  line.below = line.above = 100;
  put(line.below_has, -4, -4);
  put(line.above_has, -4, 4);
  CHECK(quiet_place_m(line) == -4);
  line.below = 90;
  line.above = 110;
  CHECK(quiet_place_m(line) == 4);
}

TEST_CASE(
    "for less than 2 % of the mean a crowd is shared out as it is, and no line moves too far for "
    "it") {
  LineSituation line = crowded();
  line.all = 499;
  line.mean = 200;
  line.below = 192;
  line.above = 208;
  CHECK(quiet_place_m(line) == 8);
  line.below = 196;  // 4 m would take 4 from whoever has more, just 2 %; and the way counts.
  line.above = 204;
  CHECK(quiet_place_m(line) == 0);
  line.mean = 190;
  CHECK(quiet_place_m(line) == 4);
  line.below = 40;
  line.above = 160;
  CHECK(quiet_place_m(line) == 12);
  line.far_m = 5;
  CHECK(quiet_place_m(line) == 4);
  line.far_m = 3;
  CHECK(quiet_place_m(line) == 0);
  // One that has left a crowd which then grew does not come back into it to share it.
  line.far_m = 45;
  line.here_m = 28;
  put(line.above_has, 24, 30);
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
