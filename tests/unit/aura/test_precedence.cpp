// Who comes first: by neighbours, by loads, by numbers.
#include "server/aura/precedence.h"

#include <array>

#include "tests/support/catch.h"
#include "tests/unit/aura/aura_maps.h"

using namespace aureole;
using aura_maps::r;

TEST_CASE("of two servers the one with fewer neighbours comes first, whatever it has to do") {
  const std::array<std::uint16_t, 3> neighbours = {8, 5, 3}, levels = {0, 1, 2};
  const Precedence order{levels, neighbours};
  CHECK(order.before(r(2), r(1)));
  CHECK(order.before(r(1), r(0)));
  CHECK_FALSE(order.before(r(0), r(2)));
  RegionSet all;
  for (int i = 0; i < 3; ++i) all.add(r(i));
  CHECK(order.first(all) == r(2));
}

TEST_CASE("of two with as many neighbours the one with less to do comes first, or the lower one") {
  const std::array<std::uint16_t, 4> neighbours = {3, 3, 3, 3}, levels = {2, 1, 2, 1};
  const Precedence order{levels, neighbours};
  CHECK(order.before(r(1), r(0)));
  CHECK(order.before(r(1), r(3)));
  CHECK(order.before(r(0), r(2)));
  CHECK_FALSE(order.before(r(2), r(0)));
}

TEST_CASE("where nothing is known of anybody numbers decide") {
  CHECK(Precedence{}.before(r(0), r(1)));
  CHECK_FALSE(Precedence{}.before(r(1), r(0)));
  CHECK_FALSE(Precedence{}.before(r(1), r(1)));
}
