// Rectangles that tile the plane, and those that do not.
#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"

namespace aureole {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

RegionDefinition region(const char* name, double min_x, double min_z, double max_x, double max_z) {
  return {name, {min_x, min_z, max_x, max_z}};
}

}  // namespace

TEST_CASE("a T of three regions tiles the plane") {
  CHECK_FALSE(tiling_mistake({region("a", -inf, -inf, 0, 0), region("b", 0, -inf, inf, 0),
                              region("c", -inf, 0, inf, inf)}));
}

TEST_CASE("a pinwheel around a middle region tiles the plane") {
  CHECK_FALSE(tiling_mistake({region("n", -inf, -inf, 10, -10), region("e", 10, -inf, inf, 10),
                              region("s", -10, 10, inf, inf), region("w", -inf, -10, -10, inf),
                              region("m", -10, -10, 10, 10)}));
}

TEST_CASE("an overlap of one sliver names both regions and its area") {
  const auto mistake = tiling_mistake({region("a", -inf, -inf, 0, 0), region("b", 0, -inf, inf, 0),
                                       region("c", -inf, 0, inf, inf), region("d", 4, 4, 4.5, 6)});
  REQUIRE(mistake);
  CHECK(mistake->find("regions \"c\" and \"d\" overlap by 1 m² around x = 4.25 m, z = 5 m") == 0);
}

TEST_CASE("a hole, and an outermost side that ends, are found with a point inside") {
  const auto hole =
      tiling_mistake({region("n", -inf, -inf, 10, -10), region("e", 10, -inf, inf, 10),
                      region("s", -10, 10, inf, inf), region("w", -inf, -10, -10, inf)});
  REQUIRE(hole);
  CHECK(hole->find("no region covers the point x = 0 m, z = 0 m") == 0);
  const auto edge =
      tiling_mistake({region("a", -inf, -inf, 0, inf), region("b", 0, -inf, 500, inf)});
  REQUIRE(edge);
  CHECK(edge->find("no region covers the point x = 501 m") == 0);
}

TEST_CASE("every split from 1 to 64 tiles the plane and has that many regions") {
  const Rectangle extent{-120, -60, 120, 60};
  for (int n = 1; n <= regions_max; ++n) {
    const auto regions = split_extent(extent, n);
    REQUIRE(regions.size() == static_cast<std::size_t>(n));
    CHECK_FALSE(tiling_mistake(regions));
    CHECK(regions.back().name == "r" + std::to_string(n - 1));
  }
  CHECK(split_extent(extent, 4)[1].area == Rectangle{0, -inf, inf, 0});
  CHECK(split_extent(extent, 2)[0].area == Rectangle{-inf, -inf, 0, inf});
  CHECK(split_extent(extent, 9)[4].area == Rectangle{-40, -20, 40, 20});
}

TEST_CASE("widths count in both directions, and infinite sides are wide") {
  CHECK(width_m({0, -inf, 30, inf}) == 30);
  CHECK(width_m({0, 0, 30, 20}) == 20);
  CHECK(width_m({}) == inf);
  CHECK(split_width_m({-120, -60, 120, 60}, 4) == 60);
  CHECK(split_width_m({-120, -60, 120, 60}, 3) == 80);
  CHECK(largest_split({-120, -60, 120, 60}, 24) == 10);
  CHECK(largest_split({-120, -60, 120, 60}, 1000) == 1);
}

TEST_CASE("a point on a side belongs to the region that begins there") {
  const auto regions = split_extent({-100, -100, 100, 100}, 4);
  CHECK(region_at(regions, -0.001, -0.001) == RegionId{0});
  CHECK(region_at(regions, 0, -0.001) == RegionId{1});
  CHECK(region_at(regions, -0.001, 0) == RegionId{2});
  CHECK(region_at(regions, 0, 0) == RegionId{3});
  CHECK(region_at(regions, 1e9, -1e9) == RegionId{1});
}

}  // namespace aureole
