// Lines that give way to who has less to do.
#include "server/aura/partition/partition_lines.h"

#include <fmt/format.h>

#include <optional>
#include <random>
#include <vector>

#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Three by three, 120 m each; the outermost go on for ever.
PartitionMap nine() {
  std::vector<Rectangle> areas;
  const std::vector<double> at{-inf, -60, 60, inf};
  for (std::size_t z = 0; z < 3; ++z)
    for (std::size_t x = 0; x < 3; ++x) areas.push_back({at[x], at[z], at[x + 1], at[z + 1]});
  return PartitionMap(std::move(areas));
}

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
  const PartitionMap map = nine();
  const PartitionLines lines(map);
  const std::vector<double> shifts = lines.shifts_m(std::vector<double>(9, 700.0));
  REQUIRE(shifts == std::vector<double>(4, 0.0));
  const std::vector<Rectangle> areas = lines.areas(shifts);
  for (std::uint16_t k = 0; k < 9; ++k) CHECK(areas[k] == map.area(RegionId{k}));
}

TEST_CASE("a line moves into the side that has more to do, for all along it") {
  const PartitionLines lines(nine());
  std::vector<double> loads(9, 1000);
  loads[4] = 1060;  // The one in the middle: 2 % more in its column, and in its row.
  const std::vector<double> shifts = lines.shifts_m(loads);
  // Of one x first: both towards the middle, in steps.
  const double expected_m = 400.0 * 20 / 2020;
  for (const double shift : {shifts[0], -shifts[1], shifts[2], -shifts[3]}) {
    CHECK(shift == Approx(expected_m).margin(PartitionLines::grain_m / 2));
    CHECK(std::fmod(shift, PartitionLines::grain_m) == 0);
  }
  const std::vector<Rectangle> areas = lines.areas(shifts);
  CHECK(areas[4] == Rectangle{-60 + shifts[0], -60 + shifts[2], 60 + shifts[1], 60 + shifts[3]});
  CHECK(areas[0] == Rectangle{-inf, -inf, -60 + shifts[0], -60 + shifts[2]});
  CHECK(areas[5] == Rectangle{60 + shifts[1], -60 + shifts[2], inf, 60 + shifts[3]});
}

TEST_CASE("a line goes no further than 12 m, and an eighth of the way to the next one") {
  std::vector<double> loads(9, 2);
  loads[4] = 1e9;
  CHECK(PartitionLines(nine()).shifts_m(loads) == std::vector<double>{12, -12, 12, -12});
  CHECK(PartitionLines(nine()).longest_shift_m() == 12);
  const PartitionLines near(pinwheel());
  CHECK(near.shifts_m(std::vector<double>{2, 2, 2, 2, 1e9}) == std::vector<double>{5, -5, 5, -5});
  CHECK(near.longest_shift_m() == 5);
}

TEST_CASE("wherever lines lie, areas tile the plane, and neighbours are the same") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> size(-3, 3);
  for (const PartitionMap& map : {nine(), pinwheel()}) {
    const PartitionLines lines(map);
    for (int round = 0; round < 200; ++round) {
      std::vector<double> loads;
      for (std::size_t k = 0; k < map.size(); ++k) loads.push_back(std::exp(size(random)));
      const std::vector<Rectangle> areas = lines.areas(lines.shifts_m(loads));
      REQUIRE(mistake_in(areas) == std::nullopt);
      const PartitionMap moved(areas);
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
  const PartitionLines lines(nine());
  double before = 0;
  for (const double least : {1.0, 1.2, 1.5, 2.0, 3.0}) {
    std::vector<double> loads(9, least);
    loads[4] = 1.06 * least;
    const double shift = lines.shifts_m(loads)[0];
    CHECK(shift == Approx(std::min(least - 1, 1.0) * 400 * 0.02 / 2.02).margin(0.125));
    CHECK((least == 1 ? shift == 0 : shift >= before));
    before = shift;
  }
}
