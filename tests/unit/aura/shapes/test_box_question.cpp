// One box asked of many others gets the answers that each gives by itself.
#include <array>
#include <limits>
#include <random>

#include "server/aura/shapes/box_question.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("a box meets whom it meets by itself, at its edges and without bounds too") {
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  // Few values, so that edges often coincide.
  const std::array<float, 9> values = {-inf, -2, -1, -0.0f, 0, 1, 2, inf, nan};
  std::mt19937 random(3);
  const auto box = [&] {
    RoughBox made{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      made.low[axis] = values[random() % values.size()];
      made.high[axis] = values[random() % values.size()];
    }
    return made;
  };
  int met = 0;
  for (int n = 0; n < 20'000; ++n) {
    const RoughBox asked = box(), other = box();
    REQUIRE(BoxQuestion(asked).met_by(other) == other.meets(asked));
    met += other.meets(asked) ? 1 : 0;
  }
  CHECK(met > 100);
}
