// Lines that give way to who has less to do.
#include "server/aura/partition/partition_lines.h"

#include <fmt/format.h>

#include <optional>
#include <random>
#include <vector>

#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"
#include "tests/support/grid_of_nine.h"

using namespace aureole;
using testing::grid_of_nine;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Four areas around a fifth, like a pinwheel: lines that end at others.
PartitionMap pinwheel() {
  return PartitionMap({{-inf, -inf, 20, -20},
                       {20, -inf, inf, 20},
                       {-20, 20, inf, inf},
                       {-inf, -20, -20, inf},
                       {-20, -20, 20, 20}});
}

std::optional<std::string> mistake_in(const std::vector<Rectangle>& areas) {
  std::vector<RegionDefinition> regions;
  for (const Rectangle& area : areas) regions.push_back({fmt::format("r{}", regions.size()), area});
  return tiling_mistake(regions);
}

}  // namespace

TEST_CASE("lines lie where the map has them while all have equally much to do") {
  const PartitionMap map = grid_of_nine();
  const PartitionLines lines(map);
  const std::vector<double> shifts = lines.shifts_m(std::vector<double>(9, 700.0));
  REQUIRE(shifts == std::vector<double>(8, 0.0));  // Two in each of three rows, two between rows.
  const std::vector<Rectangle> areas = lines.areas(shifts);
  for (std::uint16_t k = 0; k < 9; ++k) CHECK(areas[k] == map.area(RegionId{k}));
}

TEST_CASE("a line moves into the side that has more to do, for all along it") {
  const PartitionLines lines(grid_of_nine());
  std::vector<double> loads(9, 1000);
  loads[4] = 1060;  // The one in the middle.
  const std::vector<double> shifts = lines.shifts_m(loads);
  // Of one x first, from the lowest z on: in the middle's row both towards it, in steps.
  const double within_m = 200.0 * 60 / 2060, between_m = 200.0 * 20 / 2020;
  const std::vector<double> expected_m{0, within_m, 0, 0, -within_m, 0, between_m, -between_m};
  REQUIRE(shifts.size() == expected_m.size());
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    CHECK(shifts[i] == Approx(expected_m[i]).margin(PartitionLines::grain_m / 2));
    CHECK(std::fmod(shifts[i], PartitionLines::grain_m) == 0);
  }
  const std::vector<Rectangle> areas = lines.areas(shifts);
  CHECK(areas[4] == Rectangle{-60 + shifts[1], -60 + shifts[6], 60 + shifts[4], 60 + shifts[7]});
  CHECK(areas[0] == Rectangle{-inf, -inf, -60, -60 + shifts[6]});
  CHECK(areas[5] == Rectangle{60 + shifts[4], -60 + shifts[6], inf, 60 + shifts[7]});
}

TEST_CASE("in each row of a grid lines move by what its own regions have to do") {
  const PartitionLines lines(grid_of_nine());
  const std::vector<double> shifts =
      lines.shifts_m(std::vector<double>{1040, 1000, 960, 1000, 1000, 1000, 960, 1000, 1040});
  // Between rows nothing: each has as much as the others.
  CHECK(shifts == std::vector<double>{-4, 0, 4, -4, 0, 4, 0, 0});
  CHECK(mistake_in(lines.areas(shifts)) == std::nullopt);
}

TEST_CASE("around a corner of three the line that two regions meet at moves by itself") {
  const PartitionLines lines(
      PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, inf, inf}}));
  CHECK(lines.shifts_m(std::vector<double>{1040, 960, 1000}) == std::vector<double>{-8, 0});
  CHECK(lines.shifts_m(std::vector<double>{1000, 1000, 1040}) == std::vector<double>{0, 4});
}

TEST_CASE("a line goes no further than 12 m, and an eighth of the way to the next one") {
  std::vector<double> loads(9, 2);
  loads[4] = 1e9;
  CHECK(PartitionLines(grid_of_nine()).shifts_m(loads) ==
        std::vector<double>{0, 12, 0, 0, -12, 0, 12, -12});
  CHECK(PartitionLines(grid_of_nine()).longest_shift_m() == 12);
  const PartitionLines near(pinwheel());
  CHECK(near.shifts_m(std::vector<double>{2, 2, 2, 2, 1e9}) == std::vector<double>{5, -5, 5, -5});
  CHECK(near.longest_shift_m() == 5);
}

TEST_CASE("wherever lines lie, areas tile the plane, and neighbours are the same") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> size(-3, 3);
  for (const PartitionMap& map : {grid_of_nine(), pinwheel()}) {
    const PartitionLines lines(map);
    for (int round = 0; round < 200; ++round) {
      std::vector<double> loads;
      for (std::size_t k = 0; k < map.size(); ++k) loads.push_back(std::exp(size(random)));
      const std::vector<Rectangle> areas = lines.areas(lines.shifts_m(loads));
      REQUIRE(mistake_in(areas) == std::nullopt);
      const PartitionMap moved = map.moved(areas);
      REQUIRE(moved.version() > map.version());
      REQUIRE(moved.has_corners());
      for (std::uint16_t k = 0; k < map.size(); ++k)
        REQUIRE(moved.neighbours(RegionId{k}) == map.neighbours(RegionId{k}));
    }
  }
}

TEST_CASE("a world of one region has no lines") {
  const PartitionLines lines(PartitionMap(std::vector<Rectangle>(1)));
  CHECK(lines.shifts_m(std::vector<double>{500}).empty());
  CHECK(lines.areas({}) == std::vector<Rectangle>(1));
  CHECK(lines.longest_shift_m() == 0);
}

TEST_CASE(
    "a line lies still where one side has nothing to do, and moves the further the more it has") {
  const PartitionLines lines(grid_of_nine());
  double before = 0;
  for (const double least : {1.0, 1.2, 1.5, 2.0, 3.0}) {
    std::vector<double> loads(9, least);
    loads[4] = 1.06 * least;
    const double shift = lines.shifts_m(loads)[1];
    CHECK(shift == Approx(std::min(least - 1, 1.0) * 200 * 0.06 / 2.06).margin(0.125));
    CHECK((least == 1 ? shift == 0 : shift >= before));
    before = shift;
  }
}
