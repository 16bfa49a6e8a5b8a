// Injected bodies: each comes into the world once, on the server in whose region it appears.
#include "server/worlds/injector.h"

#include <array>

#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

Injector injector(double from_x, double to_x, std::uint64_t seed) {
  Injector made;
  made.name = "rain";
  made.rate_per_s = 200;
  made.volume = {{from_x, 5, -5}, {to_x, 10, 5}};
  made.mix = {{ball, 1}};
  made.seed = seed;
  return made;
}

}  // namespace

TEST_CASE("every injected body comes once, on the server whose region it appears in") {
  // Three columns, up to 50, on to 100, and beyond; in the naive mode who has just come stays where
  // it is for half a second.
  WorldDefinition world = flat_world(3, 50);
  world.mode = MigrationMode::naive;
  world.injectors = {injector(10, 40, 1), injector(40, 160, 2), injector(60, 90, 3),
                     injector(50, 60, 4)};
  RegionCluster cluster(world);
  cluster.step(25);
  const PartitionMap map = partition_of(world);
  std::size_t made = 0;
  std::array<int, 3> by_region{};
  for (std::size_t i = 0; i < world.injectors.size(); ++i) {
    const std::uint64_t count = injected_count(world.injectors[i], cluster.now());
    made += count;
    for (std::uint64_t n = 0; n < count; ++n) {
      const WorldPosition at = injected_body(world.injectors[i], n).state.position;
      const RegionId home = map.region_at(at.x, at.z);
      ++by_region[home.value];
      CAPTURE(i, n, at.x);
      CHECK(cluster.owner(BodyId::injected(static_cast<std::uint16_t>(i), n)) == home.value);
    }
  }
  CHECK(made == 4 * 80);
  CHECK(cluster.bodies_in_world() == made);
  for (const int count : by_region) CHECK(count > 20);
}
