// Extents meet where the rectangles do, edges included; what is rounded holds what it was made of.
#include "server/aura/shapes/ground_extent.h"

#include <random>

#include "tests/support/catch.h"

using namespace aureole;

namespace {

RoughBox box_of(float low_x, float low_z, float high_x, float high_z) {
  return {{low_x, -1, low_z}, {high_x, 1, high_z}};
}

bool meet(const RoughBox& a, const RoughBox& b) {
  const bool met = GroundExtent(a).meets(GroundExtent(b));
  CHECK(met == GroundExtent(b).meets(GroundExtent(a)));
  return met;
}

}  // namespace

TEST_CASE("extents that share an edge or a corner meet, and a step further they do not") {
  const RoughBox box = box_of(-1, 2, 3, 7);
  for (const float beyond : {0.f, 0.001f}) {
    const bool touches = beyond == 0;
    CHECK(meet(box, box_of(3 + beyond, 3, 9, 4)) == touches);
    CHECK(meet(box, box_of(-9, 3, -1 - beyond, 4)) == touches);
    CHECK(meet(box, box_of(0, 7 + beyond, 1, 9)) == touches);
    CHECK(meet(box, box_of(0, -9, 1, 2 - beyond)) == touches);
    CHECK(meet(box, box_of(3 + beyond, 7, 9, 9)) == touches);
  }
}

TEST_CASE("height does not matter") {
  CHECK(GroundExtent({{0, 5, 0}, {1, 6, 1}}).meets(GroundExtent({{0, 50, 0}, {1, 60, 1}})));
}

TEST_CASE("nothing that has bounds meets an extent of no boxes, nor does such an extent") {
  const GroundExtent nothing;
  const GroundExtent huge(box_of(-1e30f, -1e30f, 1e30f, 1e30f));
  CHECK(nothing.is_empty());
  CHECK_FALSE(huge.is_empty());
  CHECK_FALSE(nothing.meets(nothing));
  CHECK_FALSE(nothing.meets(huge));
  CHECK_FALSE(huge.meets(nothing));
}

TEST_CASE("an extent meets whatever any of its boxes meets") {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> place(-50, 50), size(0, 8);
  const auto any_box = [&] {
    const float x = place(random), z = place(random);
    return box_of(x, z, x + size(random), z + size(random));
  };
  for (int round = 0; round < 200; ++round) {
    GroundExtent all;
    RoughBox around = any_box();
    all.take_in(GroundExtent(around));
    for (int n = 0; n < 5; ++n) {
      const RoughBox box = any_box();
      all.take_in(GroundExtent(box));
      for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
        around.low[axis] = std::min(around.low[axis], box.low[axis]);
        around.high[axis] = std::max(around.high[axis], box.high[axis]);
      }
    }
    for (int n = 0; n < 50; ++n) {
      const RoughBox asked = any_box();
      REQUIRE(all.meets(GroundExtent(asked)) == around.meets(asked));
    }
  }
}

TEST_CASE("a rough box holds its box, and is no more than two millionths wider at either end") {
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> place(-9000, 9000), size(0, 40);
  for (int n = 0; n < 10'000; ++n) {
    const AuraBox box{{place(random), place(random), place(random)},
                      {size(random), size(random), size(random)}};
    const RoughBox rough = RoughBox::around(box);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      const double low = box.centre[i] - box.half[i], high = box.centre[i] + box.half[i];
      const double most = 2e-6 * (1 + std::max(std::abs(low), std::abs(high)));
      REQUIRE(double{rough.low[axis]} < low);
      REQUIRE(double{rough.low[axis]} >= low - most);
      REQUIRE(double{rough.high[axis]} > high);
      REQUIRE(double{rough.high[axis]} <= high + most);
    }
  }
}
