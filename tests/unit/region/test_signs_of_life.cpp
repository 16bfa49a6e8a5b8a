// How often servers hear from each other: near ones in every step, far ones in some.
#include <vector>

#include "protocol/wire.h"
#include "server/region/signs_of_life.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr double speed_mps = 32;

RegionId region(int number) {
  return RegionId{static_cast<std::uint16_t>(number)};
}

/// Columns of this width, as many as there are numbers.
PartitionMap columns(int count, double width_m) {
  std::vector<Rectangle> areas(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Rectangle& area = areas[static_cast<std::size_t>(i)];
    if (i > 0) area.min_x = i * width_m;
    if (i + 1 < count) area.max_x = (i + 1) * width_m;
  }
  return PartitionMap(std::move(areas));
}

/// How often region 0 sends an `Auras` to each of its two neighbours in `ticks`.
std::pair<int, int> words(const WorldDefinition& world, const std::vector<std::int64_t>& ticks) {
  RegionCore core(world, RegionId{0}, Incarnation{1});
  core.peer_up(PeerId::region(region(1)), Incarnation{1});
  core.peer_up(PeerId::region(region(2)), Incarnation{1});
  std::pair<int, int> said{0, 0};
  for (const std::int64_t tick : ticks) {
    core.step(Tick{tick});
    for (const Outgoing& out : core.outbox()) {
      const auto frame = decode_frame(*out.frame);
      REQUIRE(frame);
      if (frame->type != FrameType::auras) continue;
      ++(out.to == PeerId::region(region(1)) ? said.first : said.second);
    }
  }
  return said;
}

std::vector<std::int64_t> ticks(std::int64_t from, std::int64_t to) {
  std::vector<std::int64_t> all;
  for (std::int64_t tick = from; tick < to; ++tick) all.push_back(tick);
  return all;
}

}  // namespace

TEST_CASE("regions are near each other while a body gets from one to the other within 2 s") {
  // 0 and 2 are one width apart.
  CHECK(word_interval_ticks(columns(3, 64), region(0), region(2), speed_mps) == 1);
  CHECK(word_interval_ticks(columns(3, 64.1), region(0), region(2), speed_mps) ==
        far_word_interval_ticks);
  CHECK(word_interval_ticks(columns(3, 64.1), region(2), region(0), speed_mps) ==
        far_word_interval_ticks);
  CHECK(word_interval_ticks(columns(3, 1000), region(0), region(1), speed_mps) == 1);
  CHECK(word_interval_ticks(columns(3, 64.1), region(0), region(2), 33) == 1);
}

TEST_CASE("the gap of two areas is that of their nearest points") {
  const Rectangle home{0, 0, 10, 10};
  CHECK(home.distance(Rectangle{13, 14, 20, 20}) == Approx(5));
  CHECK(Rectangle{13, 14, 20, 20}.distance(home) == Approx(5));
  CHECK(home.distance(Rectangle{10, 0, 20, 10}) == 0);
  CHECK(home.distance(Rectangle{2, 2, 5, 5}) == 0);
  CHECK(home.distance(Rectangle{}) == 0);
  constexpr double none = std::numeric_limits<double>::infinity();
  CHECK(home.distance(Rectangle{-none, -none, -7, none}) == Approx(7));
}

TEST_CASE("a peer nearby hears a word in every step, one far away in one of eight") {
  const WorldDefinition world = flat_world(3, 100);
  // The first step says something to everybody; then 16, 24 and 32 begin eight ticks.
  CHECK(words(world, ticks(10, 33)) == std::pair(23, 4));
  CHECK(words(flat_world(3, 50), ticks(10, 33)) == std::pair(23, 23));
}

TEST_CASE("a word to a peer far away whose tick was left out is said in the next step") {
  CHECK(words(flat_world(3, 100), {10, 11, 15, 17, 18, 19, 26, 27}) == std::pair(8, 3));
}

TEST_CASE("servers that are far apart do not miss the words that they do not say") {
  const WorldDefinition world = flat_world(3, 100);
  RegionCluster cluster(world, 1);
  for (int i = 0; i < 100; ++i) {
    cluster.step();
    for (int server = 0; server < 3; ++server)
      REQUIRE(cluster.core(server).tolerance_events().empty());
  }
  // Region 2 falls silent towards region 0; its words are one tick on the way.
  cluster.silence(2, 0);
  int noticed_after = 0;
  for (int i = 1; i <= 20 && noticed_after == 0; ++i) {
    cluster.step();
    if (!cluster.core(0).tolerance_events().empty()) noticed_after = i;
  }
  CHECK(noticed_after > 1);
  CHECK(noticed_after <= 10);
}
