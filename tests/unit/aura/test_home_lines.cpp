// Which region a body belongs to where one server has more to do than its neighbour.
#include "server/aura/adaptive/home_lines.h"

#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

namespace {

/// 0 and 1 in the first row, 2 and 3 in the second.
PartitionMap quarters() {
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, 0, inf}, {0, 0, inf, inf}});
}

constexpr RegionId west{0}, east{1};
/// Far from the corner.
constexpr double z = -100;

struct Lines {
  PartitionMap map = quarters();
  RegionId self = west;
  std::vector<double> awake{1000, 900, 1000, 1000};
  std::vector<bool> linked = std::vector<bool>(4, true);
  HomeLines lines;

  MigrationSituation situation() const {
    return {.now = Tick{0},
            .self = self,
            .map = map,
            .hosted = {},
            .remote = {},
            .requested = {},
            .linked = linked,
            .awake = awake};
  }
  RegionId home_of(double x, double at_z, bool rests) const {
    return lines.home_of({x, 1, at_z}, rests);
  }
};

/// Four seconds, several times over.
constexpr int long_enough = 400;

}  // namespace

TEST_CASE("what stirs near the line belongs to who has had less to do for seconds") {
  Lines world;
  const MigrationSituation situation = world.situation();
  world.lines.look(situation);
  REQUIRE(world.home_of(-1, z, false) == west);  // It may be a whim.
  for (int n = 0; n < long_enough; ++n) world.lines.look(situation);
  REQUIRE(world.home_of(-1, z, false) == east);
  REQUIRE(world.home_of(-5.9, z, false) == east);  // Half of the 12 m that the line is shifted.
  REQUIRE(world.home_of(-6.1, z, false) == west);
  REQUIRE(world.home_of(-1, z, true) == west);  // What rests costs nothing where it is.
}

TEST_CASE("nothing is given away as soon as the other one has as much to do") {
  Lines world;
  const MigrationSituation before = world.situation();
  for (int n = 0; n < long_enough; ++n) world.lines.look(before);
  world.awake = {1000, 1000, 1000, 1000};
  const MigrationSituation now = world.situation();
  world.lines.look(now);
  REQUIRE(world.home_of(-1, z, false) == west);
}

TEST_CASE("nothing is given away near a third region, nor to a server that is not there") {
  Lines world;
  const MigrationSituation situation = world.situation();
  for (int n = 0; n < long_enough; ++n) world.lines.look(situation);
  REQUIRE(world.home_of(-1, -21, false) == east);
  REQUIRE(world.home_of(-1, -19, false) == west);
  world.linked[east.value] = false;
  REQUIRE(world.home_of(-1, z, false) == west);
}

TEST_CASE("nothing is given away in a world without corners") {
  Lines world;
  world.map = PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, inf, inf}});
  world.awake = {1000, 900};
  const MigrationSituation situation = world.situation();
  for (int n = 0; n < long_enough; ++n) world.lines.look(situation);
  REQUIRE(world.home_of(-1, z, false) == west);
}

TEST_CASE("what has been given stays twice as far in, and for a while when loads turn") {
  Lines world;
  world.self = east;
  const MigrationSituation before = world.situation();
  for (int n = 0; n < long_enough; ++n) world.lines.look(before);
  for (const bool rests : {false, true}) {
    REQUIRE(world.home_of(-11.9, z, rests) == east);
    REQUIRE(world.home_of(-12.1, z, rests) == west);
  }
  world.awake = {1000, 1001, 1000, 1000};
  const MigrationSituation now = world.situation();
  world.lines.look(now);
  REQUIRE(world.home_of(-11, z, false) == east);
  for (int n = 0; n < long_enough; ++n) world.lines.look(now);
  REQUIRE(world.home_of(-1, z, false) == west);
}

TEST_CASE("all belongs where it lies as soon as nobody has much to do") {
  Lines world;
  world.self = east;
  const MigrationSituation before = world.situation();
  for (int n = 0; n < long_enough; ++n) world.lines.look(before);
  REQUIRE(world.home_of(-1, z, true) == east);
  world.awake = {100, 90, 100, 100};
  const MigrationSituation now = world.situation();
  world.lines.look(now);
  REQUIRE(world.home_of(-1, z, true) == west);
}
