// Rows find what comparing each with each finds; capsules are as far apart as their points.
#include <algorithm>
#include <random>

#include "server/aura/shapes/aura_capsule.h"
#include "server/aura/shapes/box_rows.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

struct Dice {
  std::mt19937 engine{5};
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  }
  Eigen::Vector3d vector(double low, double high) {
    return {between(low, high), between(low, high), between(low, high)};
  }
};

AuraBox box_of(Dice& dice, double world_m, double half_m) {
  return {dice.vector(-world_m, world_m), dice.vector(0, half_m)};
}

double distance_by_samples(const AuraCapsule& a, const AuraCapsule& b) {
  double least = 1e9;
  for (int i = -50; i <= 50; ++i)
    for (int j = -50; j <= 50; ++j)
      least = std::min(
          least, (a.centre + i / 50.0 * a.half_spine - b.centre - j / 50.0 * b.half_spine).norm());
  return least - a.girth_m - b.girth_m;
}

}  // namespace

TEST_CASE("rows find each overlapping box once, small ones and huge ones") {
  Dice dice;
  for (const double world_m : {3.0, 40.0, 5000.0})
    for (const double half_m : {0.0, 1.5, 30.0}) {
      std::vector<AuraBox> boxes;
      for (int n = 0; n < 200; ++n) boxes.push_back(box_of(dice, world_m, half_m));
      boxes.push_back({{0, 0, 0}, {1000, 1000, 1000}});
      BoxRows rows;
      rows.build(boxes);
      for (int n = 0; n < 60; ++n) {
        const AuraBox asked =
            n < 30 ? boxes[static_cast<std::size_t>(n)] : box_of(dice, 1.2 * world_m, 2 * half_m);
        std::vector<std::uint32_t> found, expected;
        rows.find(asked, found);
        for (std::uint32_t i = 0; i < boxes.size(); ++i)
          if (boxes[i].overlaps(asked)) expected.push_back(i);
        std::sort(found.begin(), found.end());
        REQUIRE(found == expected);
      }
    }
}

TEST_CASE("what lies on both sides of an empty place is found by whoever reaches over them") {
  std::vector<AuraBox> boxes;
  for (int n = 0; n < 100; ++n)
    boxes.push_back({{n % 2 == 0 ? 0.0 : 20.0, 0, 0.05 * n}, {0.3, 0.3, 0.3}});
  BoxRows rows;
  rows.build(boxes);
  const auto count = [&](double low_x, double high_x) {
    std::vector<std::uint32_t> found;
    rows.find({{(low_x + high_x) / 2, 0, 2.5}, {(high_x - low_x) / 2, 1, 3}}, found);
    return found.size();
  };
  CHECK(count(-1, 21) == 100);
  CHECK(count(-1, 5) == 50);
  CHECK(count(15, 21) == 50);
  CHECK(count(5, 15) == 0);
}

TEST_CASE("without boxes nothing is found, and what is built again forgets the first") {
  BoxRows rows;
  std::vector<std::uint32_t> found;
  rows.find({{0, 0, 0}, {1, 1, 1}}, found);
  REQUIRE(found.empty());
  const std::vector<AuraBox> one{{{0, 0, 0}, {1, 1, 1}}}, other{{{9, 0, 0}, {1, 1, 1}}};
  rows.build(one);
  rows.build(other);
  rows.find({{0, 0, 0}, {1, 1, 1}}, found);
  REQUIRE(found.empty());
}

TEST_CASE("who comes and goes leaves rows as those of whoever is there") {
  Dice dice;
  for (const double world_m : {6.0, 60.0, 600.0}) {
    std::vector<std::pair<std::uint32_t, AuraBox>> present;  // In the order in which they came.
    std::uint32_t next = 0;
    BoxRows rows;
    for (int round = 0; round < 400; ++round) {
      // Now many at once, now few; at last all of them go.
      const int coming = round > 380       ? 0
                         : round % 40 == 0 ? 60
                                           : static_cast<int>(dice.between(0, 4));
      const int going =
          round > 380 ? 20 : static_cast<int>(dice.between(0, round % 50 == 49 ? 90 : 4));
      for (int n = 0; n < coming; ++n) {
        const AuraBox box = box_of(dice, world_m, round % 7 == 0 ? 9 : 1.5);
        present.emplace_back(next, box);
        rows.insert(next++, box);
        // One that goes before it has been sorted in.
        if (n % 5 == 4) {
          rows.erase(present.back().first, present.back().second);
          present.pop_back();
        }
      }
      for (int n = 0; n < going && !present.empty(); ++n) {
        const auto who =
            present.begin() + static_cast<std::ptrdiff_t>(dice.engine() % present.size());
        rows.erase(who->first, who->second);
        present.erase(who);
      }
      rows.settle();
      BoxRows anew;
      for (const auto& [number, box] : present) anew.insert(number, box);
      anew.settle();
      for (int n = 0; n < 12; ++n) {
        const AuraBox asked = n % 2 == 0 || present.empty()
                                  ? box_of(dice, 1.2 * world_m, 4)
                                  : present[dice.engine() % present.size()].second;
        std::vector<std::uint32_t> found, expected;
        rows.find(asked, found);
        anew.find(asked, expected);
        REQUIRE(found == expected);
      }
    }
    REQUIRE(present.empty());
  }
}

TEST_CASE("the gap of two capsules is that of their nearest points") {
  Dice dice;
  for (int n = 0; n < 300; ++n) {
    AuraCapsule a{dice.vector(-2, 2), dice.vector(-1, 1), dice.between(0, 1)};
    AuraCapsule b{dice.vector(-2, 2), dice.vector(-1, 1), dice.between(0, 1)};
    if (n % 5 == 0) a.half_spine = {0, 0, 0};
    if (n % 7 == 0) b.half_spine = {0, 0, 0};
    if (n % 11 == 0) b.half_spine = -0.5 * a.half_spine;  // Parallel.
    const double gap = gap_m(a, b), sampled = distance_by_samples(a, b);
    REQUIRE(gap == Approx(gap_m(b, a)).margin(1e-9));
    REQUIRE(gap <= sampled + 1e-9);
    REQUIRE(gap >= sampled - 0.03);
    REQUIRE(overlap(a, b) == (gap <= 0));
    if (overlap(a, b)) REQUIRE(a.box().overlaps(b.box()));
  }
}
