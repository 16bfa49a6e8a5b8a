// Around a corner every region hears of what rests; where it stands, in whole regions.
#include <algorithm>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

/// Four regions around (50, 0), numbered (x, z) low low, high low, low high, high high. A box of
/// region 0 sleeps at the boundary to region 1, 6 m from the corner.
struct Corner {
  WorldDefinition world = flat_world(2);
  BodyId sleeper;

  Corner() {
    for (const int below : {0, 1}) {
      RegionDefinition above = world.regions[static_cast<std::size_t>(below)];
      world.regions[static_cast<std::size_t>(below)].area.max_z = above.area.min_z = 0;
      above.name += " above";
      world.regions.push_back(above);
    }
    sleeper = put(world, box, {49.4, 0.5, -6}, {0, 0, 0}, Activation::asleep);
  }
};

std::size_t stand_ins(RegionCluster& cluster, int region) {
  return cluster.core(region).statistics().stand_ins;
}

}  // namespace

TEST_CASE("what rests along a boundary stands where somebody is near, not all around the corner") {
  Corner corner;
  put(corner.world, ball, {60, 0.3, -6});  // Region 1 has a body beside it, …
  put(corner.world, ball, {95, 0.3, 45});  // … region 3 one far away.
  RegionCluster cluster(corner.world);
  cluster.step(20);
  REQUIRE(cluster.owner(corner.sleeper) == 0);
  CHECK(stand_ins(cluster, 1) == 1);
  CHECK(stand_ins(cluster, 2) == 0);
  CHECK(stand_ins(cluster, 3) == 0);
  REQUIRE(cluster.faults().empty());
}

TEST_CASE("who comes near finds what rests there standing, and when all have left it is put away") {
  Corner corner;
  const BodyId visitor = put(corner.world, ball, {88, 0.3, 31}, {-12, 0, -9});
  RegionCluster cluster(corner.world);
  cluster.step(20);
  REQUIRE(cluster.owner(visitor) == 3);
  CHECK(stand_ins(cluster, 3) == 0);
  std::size_t most = 0;
  for (int i = 0; i < 400 && cluster.owner(visitor) == 3; ++i) {
    cluster.step();
    if (cluster.owner(visitor) == 3) most = std::max(most, stand_ins(cluster, 3));
  }
  CHECK(most == 1);
  cluster.step(1024);
  CHECK(stand_ins(cluster, 3) == 0);
  REQUIRE(cluster.owner(corner.sleeper) == 0);
  REQUIRE(cluster.faults().empty());
}

TEST_CASE("what is handed over finds standing what it lies on, from its first step on") {
  Corner corner;
  RegionCluster cluster(corner.world);
  cluster.step(20);
  CHECK(stand_ins(cluster, 3) == 0);
  const BodyId above = BodyId::thrown(PlayerId{1}, 0);
  HandoffGroup group;
  group.tick = cluster.now();
  group.bodies.push_back({{above, box, {}}, 1});
  BodyState& state = group.bodies.back().body.state;
  state.position = {49.4, 1.5, -6};
  RegionCore& core = cluster.core(3);
  REQUIRE(core.receive(PeerId{0}, Frame{FrameType::handoff, 1, encode_handoff(group)}));
  core.step(cluster.now() + 1);
  REQUIRE(core.physics().contains(above));
  // In one step gravity alone makes it 0.16 m/s.
  CHECK(core.physics().state(above).linear_velocity.y() > -0.02f);
}
