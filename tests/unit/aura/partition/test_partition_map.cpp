// Who owns which point, who neighbours whom, where boundaries run: columns, 2×2, T-shapes.
#include "server/aura/partition/partition_map.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/aura_maps.h"

using namespace aureole;
using namespace aureole::aura_maps;

TEST_CASE("every point has exactly one owner, also on edges and corners") {
  const auto map = quarters();
  REQUIRE(map.region_at(-1, -1) == r(0));
  REQUIRE(map.region_at(0, -1) == r(1));
  REQUIRE(map.region_at(-1, 0) == r(2));
  REQUIRE(map.region_at(0, 0) == r(3));
  REQUIRE(map.region_at(-1e9, 1e9) == r(2));
  for (double x = -2; x <= 2; x += 0.25)
    for (double z = -2; z <= 2; z += 0.25) {
      int owners = 0;
      for (int i = 0; i < 4; ++i) owners += map.area(r(i)).contains(x, z);
      REQUIRE(owners == 1);
    }
}

TEST_CASE("a point that is not a number still has an owner") {
  REQUIRE(quarters().region_at(NAN, 3) == r(0));
}

TEST_CASE("regions that share only a corner are neighbours") {
  const auto map = quarters();
  REQUIRE(map.neighbours(r(0)) == regions({1, 2, 3}));
  REQUIRE(map.neighbours(r(3)) == regions({0, 1, 2}));
}

TEST_CASE("three regions meet at a corner, and nowhere between columns") {
  REQUIRE(quarters().has_corners());
  REQUIRE(t_shape().has_corners());
  REQUIRE_FALSE(PartitionMap({{-inf, -inf, inf, inf}}).has_corners());
  REQUIRE_FALSE(PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, inf, inf}}).has_corners());
  REQUIRE_FALSE(
      PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, 50, inf}, {50, -inf, inf, inf}}).has_corners());
}

TEST_CASE("columns neighbour only the columns beside them") {
  const PartitionMap map({{-inf, -inf, 0, inf}, {0, -inf, 50, inf}, {50, -inf, inf, inf}});
  REQUIRE(map.neighbours(r(0)) == regions({1}));
  REQUIRE(map.neighbours(r(1)) == regions({0, 2}));
  REQUIRE(map.boundaries().size() == 2);
}

TEST_CASE("a shared corner is no boundary") {
  const auto map = quarters();
  for (const auto& b : map.boundaries()) {
    const bool diagonal =
        (b.first == r(0) && b.second == r(3)) || (b.first == r(1) && b.second == r(2));
    REQUIRE_FALSE(diagonal);
  }
  REQUIRE(map.boundaries().size() == 4);
}

TEST_CASE("at a T-shaped corner the wide side's edge is cut into its neighbours' pieces") {
  const auto map = t_shape();
  REQUIRE(map.neighbours(r(2)) == regions({0, 1}));
  REQUIRE(map.boundaries().size() == 3);
  const auto& left = map.boundaries()[1];
  REQUIRE(left.first == r(0));
  REQUIRE(left.second == r(2));
  REQUIRE(left.from_z == 0);
  REQUIRE(left.to_z == 0);
  REQUIRE(left.to_x == 0);
  REQUIRE(left.from_x == -inf);
}

TEST_CASE("a circle over a corner touches every region around it") {
  REQUIRE(quarters().regions_within(1, 1, 0.5) == regions({3}));
  REQUIRE(quarters().regions_within(1, 1, 1.1) == regions({1, 2, 3}));
  REQUIRE(quarters().regions_within(1, 1, 1.5) == regions({0, 1, 2, 3}));
  REQUIRE(t_shape().regions_within(0.2, 0.1, 0.3) == regions({0, 1, 2}));
}
