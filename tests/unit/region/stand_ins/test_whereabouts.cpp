// Near and far, in squares, over random places.
#include "server/region/stand_ins/whereabouts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("near is who is less than two edges from somebody, and nobody who is three away") {
  std::mt19937 random(7);
  const auto metres = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  for (int round = 0; round < 200; ++round) {
    // Some worlds are wider than there are squares, and some bodies are outside.
    const double half = std::exp(std::uniform_real_distribution<double>(1, 8)(random));
    Whereabouts whereabouts({{-half, 0, -half}, {half, 10, half}}, metres(3) + 3);
    const double edge = whereabouts.edge_m();
    REQUIRE(edge >= 8);
    std::vector<WorldPosition> noted;
    for (int i = 0; i < 4; ++i) {
      noted.push_back({metres(1.2 * half), metres(100), metres(1.2 * half)});
      whereabouts.note(noted.back());
    }
    for (int i = 0; i < 200; ++i) {
      const WorldPosition asked{metres(1.2 * half), metres(100), metres(1.2 * half)};
      // Beyond the bounds everything is along them.
      const auto inside = [&](double v) { return std::clamp(v, -half, half); };
      double nearest = std::numeric_limits<double>::infinity();
      for (const WorldPosition& at : noted)
        nearest = std::min(nearest, std::max(std::abs(inside(at.x) - inside(asked.x)),
                                             std::abs(inside(at.z) - inside(asked.z))));
      if (nearest < 2 * edge) REQUIRE(whereabouts.is_near(asked));
      if (nearest > 3 * edge) REQUIRE_FALSE(whereabouts.is_near(asked));
    }
    whereabouts.forget_all();
    REQUIRE_FALSE(whereabouts.is_near(noted.front()));
  }
}

TEST_CASE("whoever comes to where somebody has been brings nothing near") {
  Whereabouts whereabouts({{-100, 0, -100}, {100, 10, 100}}, 1);
  REQUIRE_FALSE(whereabouts.take_grown());
  whereabouts.note({1, 0, 1});
  REQUIRE(whereabouts.take_grown());
  whereabouts.note({2, 5, 2});
  REQUIRE_FALSE(whereabouts.take_grown());
  whereabouts.note({50, 0, 2});
  REQUIRE(whereabouts.take_grown());
}

TEST_CASE("a place that is not a number is in some square") {
  Whereabouts whereabouts({{-100, 0, -100}, {100, 10, 100}}, 1);
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double far = std::numeric_limits<double>::infinity();
  for (const double x : {none, far, -far})
    for (const double z : {none, far, -far}) {
      whereabouts.note({x, 0, z});
      REQUIRE(whereabouts.is_near({x, 0, z}));
    }
}
