// When servers decide: all of them at the same ticks, and whoever was held up as soon as it can.
#include <set>

#include "protocol/wire.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

/// The ticks, of these, at which a server tells its neighbour where something moves.
std::set<std::int64_t> telling_ticks(MigrationMode mode, const std::vector<std::int64_t>& ticks) {
  WorldDefinition world = flat_world(2, 50);
  world.mode = mode;
  put(world, ball, {49.9, 20, 0}, {0, 0, 3});
  RegionCore core(world, RegionId{0}, Incarnation{1});
  core.peer_up(PeerId{1}, Incarnation{1});
  std::set<std::int64_t> told;
  for (const std::int64_t tick : ticks) {
    core.step(Tick{tick});
    int words = 0;
    for (const Outgoing& out : core.outbox()) {
      const auto frame = decode_frame(*out.frame);
      REQUIRE(frame);
      if (frame->type != FrameType::auras) continue;
      ++words;
      const auto* message = verified<wire::Auras>(frame->payload);
      REQUIRE(message != nullptr);
      if (message->auras() != nullptr || message->moved() != nullptr) told.insert(tick);
    }
    // Silence means that the server is gone.
    CHECK(words == 1);
  }
  return told;
}

}  // namespace

TEST_CASE("in the adaptive mode decisions are made and told at every second tick") {
  CHECK(telling_ticks(MigrationMode::adaptive, {10, 11, 12, 13, 14, 15}) ==
        std::set<std::int64_t>{10, 12, 14});
  // Whoever starts does not wait.
  CHECK(telling_ticks(MigrationMode::adaptive, {11, 12, 13}) == std::set<std::int64_t>{11, 12});
}

TEST_CASE("a decision whose tick was left out is made at the next one") {
  CHECK(telling_ticks(MigrationMode::adaptive, {10, 11, 13, 14, 15, 18, 19}) ==
        std::set<std::int64_t>{10, 13, 14, 18});
}

TEST_CASE("the published method decides at every tick") {
  CHECK(telling_ticks(MigrationMode::paper, {10, 11, 12, 13}) ==
        std::set<std::int64_t>{10, 11, 12, 13});
}
