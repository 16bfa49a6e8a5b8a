// Thousands of touching bodies that change their server at once.
#include <map>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr int across = 20, deep = 20, high = 5;

/// Two thousand balls of 0.6 m in a block, as near to each other as contacts are; on a floor
/// without friction they begin to settle at once.
std::vector<BodyId> block_of_two_thousand(WorldDefinition& world) {
  std::vector<BodyId> ids;
  for (int y = 0; y < high; ++y)
    for (int x = 0; x < across; ++x)
      for (int z = 0; z < deep; ++z) {
        ids.push_back(put(world, ball, {51 + 0.598 * x, 0.3 + 0.598 * y, 0.598 * z}));
        world.bodies.back().host = RegionId{0};
      }
  return ids;
}

struct Sent {
  std::size_t bytes = 0, bodies = 0, contacts = 0, messages = 0;
};

/// What is on its way, or has not been acknowledged.
Sent in_journal(RegionCluster& cluster, const WorldDefinition& world) {
  Sent sent;
  for (const auto& entry : cluster.core(0).journal(RegionId{1}).unacknowledged()) {
    if (entry.type != FrameType::handoff) continue;
    const auto group = decode_handoff(entry.payload, world.prototypes.size(), world.statics.size());
    REQUIRE(group);
    ++sent.messages;
    sent.bytes += entry.payload.size();
    sent.bodies += group->bodies.size();
    sent.contacts += group->contacts.size();
  }
  return sent;
}

}  // namespace

TEST_CASE(
    "a group of two thousand touching bodies is handed over whole, in few bytes, at one tick") {
  for (const auto mode : {MigrationMode::naive, MigrationMode::adaptive}) {
    auto world = flat_world(2);
    world.mode = mode;
    const std::vector<BodyId> block = block_of_two_thousand(world);
    RegionCluster cluster(world, 1);
    // Nobody leaves before contacts have formed.
    cluster.cut_link(0, 1);
    cluster.step(10);
    cluster.reset_link(0, 1);
    Sent sent;
    std::map<Tick, std::size_t> arrived;  // How many are with the new owner, when that changes.
    for (int tick = 0; tick < 120 && cluster.core(1).physics().size() < block.size(); ++tick) {
      cluster.step();
      if (sent.bodies == 0) sent = in_journal(cluster, world);
      const std::size_t there = cluster.core(1).physics().size();
      if (there > 0) arrived[cluster.now()] = there;
      REQUIRE(cluster.bodies_in_world() == block.size());
    }
    INFO("mode " << name_of(mode) << ": " << sent.bytes << " bytes, " << sent.bodies << " bodies, "
                 << sent.contacts << " contacts, " << sent.messages << " messages");
    CHECK(sent.messages == 1);
    CHECK(sent.bodies == block.size());
    CHECK(sent.contacts > block.size());
    // 252 bytes a body with 1.3 contacts each, when this was written.
    CHECK(sent.bytes < 328 * block.size());
    REQUIRE(arrived.size() == 1);
    CHECK(arrived.begin()->second == block.size());
    CHECK(cluster.core(0).physics().size() == 0);
    CHECK(cluster.core(1).statistics().version_conflicts == 0);
    CHECK(cluster.faults().empty());
  }
}
