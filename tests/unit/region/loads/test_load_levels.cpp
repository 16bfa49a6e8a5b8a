// Loads as levels: chosen ahead, and the same for whoever has heard.
#include <string>
#include <vector>

#include "protocol/wire.h"
#include "server/region/loads/load_levels.h"
#include "server/region/region_core.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;

namespace {

constexpr RegionId ours{0}, theirs{1};
constexpr std::int64_t term = LoadLevels::term_ticks, half = term / 2;

std::vector<std::uint16_t> in_force(LoadLevels& levels, std::int64_t tick) {
  const auto now = levels.in_force(Tick{tick});
  return {now.begin(), now.end()};
}

}  // namespace

TEST_CASE("a level is chosen when the term is half over, and in force from the next one on") {
  LoadLevels levels(2, ours);
  CHECK(levels.tell(Tick{half - 16}, 1000) == LoadLevels::Told{0, LoadLevels::unknown});
  const LoadLevels::Told told = levels.tell(Tick{half}, 1000);
  CHECK(told.now == 0);
  CHECK(told.next == 70);  // 128 × 1.03^70 = 1,013
  CHECK(levels.tell(Tick{half + 16}, 4000) == told);
  CHECK(in_force(levels, term - 1) == std::vector<std::uint16_t>{0, 0});
  CHECK(in_force(levels, term) == std::vector<std::uint16_t>{70, 0});
}

TEST_CASE("a load that is less than a level away leaves the level as it is") {
  LoadLevels levels(2, ours);
  levels.tell(Tick{half}, 1000);
  CHECK(levels.tell(Tick{term + half}, 1020).next == 70);
  CHECK(levels.tell(Tick{2 * term + half}, 990).next == 70);
  CHECK(levels.tell(Tick{3 * term + half}, 1060).next == 72);
}

TEST_CASE("a level is kept while fewer bodies more are awake than hang together") {
  LoadLevels levels(2, ours);
  levels.tell(Tick{half}, 1000);
  CHECK(levels.tell(Tick{term + half}, 1800, 900).next == 70);
  CHECK(levels.tell(Tick{2 * term + half}, 200, 900).next == 70);
  CHECK(levels.tell(Tick{3 * term + half}, 1800, 700).next > 70);
}

TEST_CASE("what was in force a second ago is known until it does not matter any more") {
  LoadLevels levels(2, ours);
  levels.hear(theirs, Tick{half}, {0, 9});
  const auto before = [&](std::int64_t tick) { return levels.in_force_before(Tick{tick})[1]; };
  CHECK(before(term) == 0);
  CHECK(before(term + 63) == 0);
  CHECK(before(term + 64) == 9);
  CHECK(before(0) == 0);
}

TEST_CASE("loads below the least are all alike") {
  LoadLevels levels(2, ours);
  CHECK(levels.tell(Tick{half}, 127).next == 0);
  CHECK(levels.tell(Tick{term + half}, 5).next == 0);
  levels.level_from(4);
  CHECK(levels.tell(Tick{2 * term + half}, 5).next > 0);
}

TEST_CASE("who was last whatever it had to do is at the level of its load again") {
  LoadLevels levels(2, ours);
  const auto last = [](std::uint16_t) { return LoadLevels::last; };
  CHECK(levels.tell(Tick{half}, last).next == LoadLevels::last);
  CHECK(levels.tell(Tick{term + half}, 1000) == LoadLevels::Told{LoadLevels::last, 70});
  CHECK(levels.tell(Tick{2 * term + half}, 1e300).next < LoadLevels::last);
}

TEST_CASE("who is a moment ahead or behind goes by the same levels at the same tick") {
  LoadLevels levels(2, ours);
  levels.hear(theirs, Tick{half}, {0, 9});
  levels.hear(theirs, Tick{term + half}, {9, 4});
  levels.hear(theirs, Tick{2 * term}, {4, LoadLevels::unknown});
  CHECK(in_force(levels, 2 * term - 1) == std::vector<std::uint16_t>{0, 9});
  CHECK(in_force(levels, 2 * term) == std::vector<std::uint16_t>{0, 4});
}

TEST_CASE("who has not heard of a term goes by the last that it has heard of") {
  LoadLevels levels(2, ours);
  levels.hear(theirs, Tick{half}, {0, 9});
  CHECK(in_force(levels, 10 * term) == std::vector<std::uint16_t>{0, 9});
  SECTION("until a status says what is in force") {
    levels.hear(theirs, Tick{10 * term}, {3, LoadLevels::unknown});
    CHECK(in_force(levels, 10 * term + 1) == std::vector<std::uint16_t>{0, 3});
  }
}

TEST_CASE("a server that has started again is at the level that it tells") {
  LoadLevels levels(2, ours);
  levels.hear(theirs, Tick{half}, {0, 9});
  levels.hear(theirs, Tick{term}, {9, LoadLevels::unknown});
  levels.hear(theirs, Tick{term + 20}, {0, LoadLevels::unknown});
  CHECK(in_force(levels, term + 20) == std::vector<std::uint16_t>{0, 0});
}

TEST_CASE("a server that was held up over the time of choosing stays at its level") {
  LoadLevels levels(2, ours);
  levels.tell(Tick{half}, 1000);
  CHECK(levels.tell(Tick{7 * term}, 9000) == LoadLevels::Told{70, LoadLevels::unknown});
  CHECK(in_force(levels, 7 * term) == std::vector<std::uint16_t>{70, 0});
}

TEST_CASE("whatever ticks and levels come, one is in force for every region") {
  LoadLevels levels(3, ours);
  for (const std::int64_t tick : {1'000'000'000LL, 5LL, 77'777LL, 5'000'000'000LL, 0LL})
    levels.hear(theirs, Tick{tick}, {0xFFFF, 0xFFFE});
  CHECK(levels.in_force(Tick{100}).size() == 3);
}

namespace {

/// The statuses that region 0 sends to region 1 in the step to a tick.
std::vector<LoadLevels::Told> told_in(RegionCore& core, std::int64_t tick) {
  core.step(Tick{tick});
  std::vector<LoadLevels::Told> told;
  for (const Outgoing& out : core.outbox()) {
    const auto frame = decode_frame(*out.frame);
    REQUIRE(frame);
    if (frame->type != FrameType::region_status || !out.to.is_region()) continue;
    const auto* status = verified<wire::RegionStatus>(frame->payload);
    REQUIRE(status != nullptr);
    told.push_back({status->level(), status->next_level()});
  }
  return told;
}

Status hears_status(RegionCore& core, std::int64_t tick) {
  flatbuffers::FlatBufferBuilder builder;
  wire::RegionStatusBuilder status(builder);
  status.add_tick(tick);
  const Bytes bytes = finish_frame(builder, status.Finish(), FrameType::region_status);
  const auto frame = decode_frame(bytes);
  REQUIRE(frame);
  return core.receive(PeerId::region(theirs), *frame);
}

/// Four balls fall in the region of `ours`, beside two others.
WorldDefinition corner_world() {
  WorldDefinition world = testing::flat_world(2);
  RegionDefinition other = world.regions[1];
  other.name = "beside it";
  other.area.min_z = world.regions[1].area.max_z = 0;
  world.regions.push_back(other);
  for (int i = 0; i < 4; ++i) testing::put(world, testing::ball, {25, 30.0 + 2 * i, 0});
  return world;
}

}  // namespace

TEST_CASE("a server tells its level in every status, and at once to who is new") {
  const WorldDefinition world = corner_world();
  RegionCore core(world, ours, Incarnation{1});
  core.level_from(1);
  core.peer_up(PeerId::region(theirs), Incarnation{1});
  CHECK(told_in(core, 1) == std::vector{LoadLevels::Told{0, LoadLevels::unknown}});
  std::uint16_t next = 0;
  for (std::int64_t tick = 2; tick <= term; ++tick) {
    const auto told = told_in(core, tick);
    CHECK(told.size() == (tick % RegionCore::status_interval_ticks == 0 ? 1 : 0));
    if (told.empty()) continue;
    const bool chosen = tick >= half && tick < term;
    CHECK((told[0].next != LoadLevels::unknown) == chosen);
    if (chosen) next = told[0].next;
    CHECK(told[0].now == (tick == term ? next : 0));
  }
  CHECK(next > 20);  // About four bodies awake.
}

TEST_CASE("a server of columns, where three never meet, tells of no level") {
  WorldDefinition world = testing::flat_world(2);
  for (int i = 0; i < 4; ++i) testing::put(world, testing::ball, {25, 30.0 + 2 * i, 0});
  RegionCore core(world, ours, Incarnation{1});
  core.level_from(1);
  core.peer_up(PeerId::region(theirs), Incarnation{1});
  for (std::int64_t tick = 1; tick <= 2 * term; ++tick)
    for (const LoadLevels::Told& told : told_in(core, tick)) {
      CHECK(told.now == 0);
      CHECK((told.next == 0 || told.next == LoadLevels::unknown));
    }
}

TEST_CASE("a server whose messages are slow is last, whatever it has to do") {
  for (const double latency_ms : {2.0, 3.0, 100.0}) {
    INFO("latency tolerance " << latency_ms << " ms");
    WorldDefinition world = corner_world();
    world.tolerances.latency_ms = latency_ms;
    RegionCore core(world, ours, Incarnation{1});
    core.level_from(1);
    core.peer_up(PeerId::region(theirs), Incarnation{1});
    std::uint16_t now = 0;
    for (std::int64_t tick = 1; tick <= term; ++tick)
      for (const LoadLevels::Told& told : told_in(core, tick)) now = told.now;
    CHECK((now == LoadLevels::last) == (latency_ms > 2));
  }
}

TEST_CASE("a status of a tick that cannot be is refused with a sentence") {
  const WorldDefinition world = testing::flat_world(2);
  RegionCore core(world, ours, Incarnation{1});
  core.peer_up(PeerId::region(theirs), Incarnation{1});
  CHECK(hears_status(core, 16));
  for (const std::int64_t tick : {wire_tick_max + 1, -wire_tick_max - 1}) {
    const Status refused = hears_status(core, tick);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("expected at most") != std::string::npos);
  }
}
