// Section 3.1: hand over on crossing, with the little that keeps it from thrashing.
#include "server/aura/migration_policy.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
const PartitionMap halves({{-inf, -inf, 0, inf}, {0, -inf, inf, inf}});
constexpr Tick long_ago{-1000};
const std::vector<bool> linked{true, true};

HostedBody at(int n, double x, Tick changed = long_ago, BodyId leader = {}) {
  HostedBody body;
  body.id = BodyId::world(static_cast<std::uint32_t>(n));
  body.position = {x, 1, 0};
  body.half_extents = {0.3, 0.3, 0.3};
  body.leader = leader;
  body.changed_owner = changed;
  return body;
}

std::vector<Migration> decide(std::vector<HostedBody> bodies, Tick now = Tick{0}) {
  return make_naive_policy()->decide({now, RegionId{0}, halves, bodies, {}, {}, linked}).leaving;
}

}  // namespace

TEST_CASE("a body whose centre has crossed is handed over") {
  const auto groups = decide({at(0, -1), at(1, 0.06)});
  REQUIRE(groups.size() == 1);
  REQUIRE(groups[0].to == RegionId{1});
  REQUIRE(groups[0].bodies == std::vector{BodyId::world(1)});
}

TEST_CASE("a body on the line stays where it is") {
  REQUIRE(decide({at(0, 0.0), at(1, naive_hysteresis_m)}).empty());
}

TEST_CASE("a body stays at least half a second with each owner") {
  REQUIRE(decide({at(0, 1, Tick{100})}, Tick{100 + stay_ticks - 1}).empty());
  REQUIRE(decide({at(0, 1, Tick{100})}, Tick{100 + stay_ticks}).size() == 1);
}

TEST_CASE("bodies that cross in the same step travel as one group") {
  const auto groups = decide({at(0, 1), at(1, 2), at(2, 3)});
  REQUIRE(groups.size() == 1);
  REQUIRE(groups[0].bodies.size() == 3);
}

TEST_CASE("what is carried goes with the one who carries it and never by itself") {
  const BodyId carrier = BodyId::world(0);
  REQUIRE(decide({at(0, -0.5), at(1, 0.8, long_ago, carrier)}).empty());
  const auto groups = decide({at(0, 0.5), at(1, -0.3, long_ago, carrier)});
  REQUIRE(groups.size() == 1);
  REQUIRE(groups[0].bodies.size() == 2);
}
