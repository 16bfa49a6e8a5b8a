// The grid of spheres against looking at every pair.
#include <algorithm>
#include <random>

#include "server/aura/shapes/sphere_grid.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::vector<Sphere> scattered(std::size_t count, double width_m, unsigned seed) {
  std::mt19937 random(seed);
  const auto up_to = [&](double high) {
    return high * static_cast<double>(random()) / 4294967296.0;
  };
  std::vector<Sphere> spheres(count);
  for (Sphere& sphere : spheres) {
    sphere.centre = {up_to(width_m), up_to(10), up_to(width_m)};
    sphere.radius = up_to(3);
  }
  return spheres;
}

std::vector<std::uint32_t> by_looking_at_all(const std::vector<Sphere>& spheres,
                                             const Sphere& one) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < spheres.size(); ++i)
    if (spheres[i].overlaps(one)) found.push_back(i);
  return found;
}

}  // namespace

TEST_CASE("the grid finds exactly the spheres that overlap, in a heap and in a wide world") {
  for (const double width_m : {0.0, 20.0, 16'000.0}) {
    const auto spheres = scattered(300, width_m, 5);
    SphereGrid grid;
    grid.build(spheres);
    for (Sphere one : scattered(100, width_m * 1.2 + 1, 6)) {
      const auto expected = by_looking_at_all(spheres, one);
      std::vector<std::uint32_t> found;
      grid.find(one, found);
      REQUIRE(found == expected);
      REQUIRE(grid.any(one) == !expected.empty());
    }
  }
}

TEST_CASE("what has been taken from the grid is not found again") {
  const auto spheres = scattered(300, 30, 7);
  SphereGrid grid;
  grid.build(spheres);
  std::vector<std::uint32_t> taken, left;
  for (const Sphere& one : spheres) grid.take(one, taken);
  std::sort(taken.begin(), taken.end());
  REQUIRE(taken.size() == spheres.size());
  REQUIRE(std::adjacent_find(taken.begin(), taken.end()) == taken.end());
  for (const Sphere& one : spheres) grid.find(one, left);
  REQUIRE(left.empty());
  REQUIRE_FALSE(grid.any(spheres[0]));
}

TEST_CASE("an empty grid finds nothing") {
  SphereGrid grid;
  grid.build({});
  REQUIRE_FALSE(grid.any({{0, 0, 0}, 100}));
}
