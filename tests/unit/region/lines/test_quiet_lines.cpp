// Lines of a row of regions: the same for all who have heard, whoever starts anew in between.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "server/region/lines/home_lines.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;

namespace {

constexpr std::int64_t term = LoadLevels::term_ticks, half = term / 2;
constexpr RegionId first{0}, second{1}, third{2};

PartitionMap row() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  return PartitionMap({{-inf, -inf, -75, inf}, {-75, -inf, 75, inf}, {75, -inf, inf, inf}});
}

/// Three servers that tell each other at every sixteenth tick; between the first two a crowd.
struct Servers {
  std::vector<HomeLines> all;
  bool nobody_is_awake = false;

  Servers() {
    for (std::uint16_t k = 0; k < 3; ++k) all.push_back(made(RegionId{k}));
  }
  static HomeLines made(RegionId self) {
    HomeLines lines(row(), self, HomeLines::Rule::quiet_places);
    lines.level_from(8, {.crowd_share = 1});
    return lines;
  }
  static std::vector<NewBody> awake(std::uint16_t k) {
    std::vector<NewBody> bodies(k == 0 ? 60 : 100);
    // Most are at the middles of regions, twenty of each side near the line, up to 24 m beyond it.
    for (NewBody& body : bodies) body.state.position = {-200.0 + 200 * k, 1, 0};
    for (std::size_t i = 0; i < 20; ++i) {
      if (k == 0) bodies[i].state.position.x = -75 - 4;
      if (k == 1) bodies[i].state.position.x = i < 10 ? -75 + 8 : -75 + 20;
    }
    return bodies;
  }
  /// `deaf`: hears nobody, and nobody hears it.
  void run(std::int64_t from, std::int64_t to, std::optional<RegionId> deaf = {}) {
    for (std::int64_t tick = from; tick < to; ++tick) {
      for (HomeLines& lines : all) lines.move(Tick{tick});
      if (tick % 16 == 0) tell(Tick{tick}, deaf);
    }
  }
  void tell(Tick now, std::optional<RegionId> deaf) {
    for (std::uint16_t k = 0; k < 3; ++k) {
      all[k].note_awake(nobody_is_awake ? std::vector<NewBody>{} : awake(k), {});
      const LineNews told = all[k].tell(now, 0);
      for (std::uint16_t other = 0; other < 3; ++other)
        if (other != k && deaf != RegionId{other} && deaf != RegionId{k})
          all[other].hear(RegionId{k}, now, told);
    }
  }
  double line_m(RegionId seen_by) const { return all[seen_by.value].map().area(first).max_x + 75; }
};

}  // namespace

TEST_CASE("a line goes to a quiet place, by a step in a term, for all servers at the same tick") {
  Servers servers;
  double before = 0;
  for (std::int64_t tick = 0; tick < 12 * term; ++tick) {
    servers.run(tick, tick + 1);
    const double line_m = servers.line_m(first);
    for (const RegionId region : {second, third}) {
      REQUIRE(servers.line_m(region) == line_m);
      REQUIRE(servers.all[region.value].margin_m() == 0);
    }
    REQUIRE(line_m >= before);
    REQUIRE(line_m - before <= LineKeeper::step_m);
    before = line_m;
  }
  CHECK(before == 32);  // The nearest place that has nobody within 8 m.
  // The other line has nobody near it.
  CHECK(servers.all[0].map().area(second).max_x == 75);
}

TEST_CASE("lines are settled once hardly anybody is awake and nothing is on its way any more") {
  Servers servers;
  servers.run(0, half + 32);  // The first step has been told.
  CHECK_FALSE(servers.all[second.value].settled());
  servers.nobody_is_awake = true;
  bool settled = false;
  for (std::int64_t tick = half + 32; tick < 8 * term; ++tick) {
    const double before = servers.line_m(second);
    servers.run(tick, tick + 1);
    // Who has said that they are does not see them move any more.
    if (settled) REQUIRE(servers.line_m(second) == before);
    settled = servers.all[second.value].settled();
  }
  CHECK(servers.line_m(first) == LineKeeper::step_m);
  for (const HomeLines& lines : servers.all) CHECK(lines.settled());
}

TEST_CASE("a line stays where it is while its keeper does not hear of everybody") {
  Servers servers;
  servers.run(0, half + 32);
  const double there_m = servers.line_m(first);
  servers.run(half + 32, 8 * term, third);
  // What had been told before is kept; who was not there knows that it may have missed something.
  CHECK(std::abs(servers.line_m(third) - servers.line_m(first)) <= 2 * LineKeeper::step_m);
  CHECK(servers.line_m(first) - there_m <= 2 * LineKeeper::step_m);
  CHECK(servers.line_m(first) < 32);
  CHECK(servers.all[third.value].margin_m() == 4 * LineKeeper::step_m);
  servers.run(8 * term, 20 * term);
  CHECK(servers.line_m(third) == 32);
  CHECK(servers.all[third.value].margin_m() == 0);
}

TEST_CASE("who starts anew is told where its line lies, and tells nobody else before") {
  Servers servers;
  servers.run(0, 12 * term);
  REQUIRE(servers.line_m(second) == 32);
  servers.all[first.value] = Servers::made(first);
  servers.run(12 * term, 12 * term + 1);
  // It knows nothing of what others know: nothing is told of where the line is, and all is feared.
  CHECK(servers.all[first.value].margin_m() == 90);
  for (std::int64_t tick = 12 * term + 1; tick < 20 * term; ++tick) {
    servers.run(tick, tick + 1);
    REQUIRE(servers.line_m(second) == 32);
    REQUIRE(servers.line_m(third) == 32);
  }
  CHECK(servers.line_m(first) == 32);
  CHECK(servers.all[first.value].margin_m() == 0);
}

TEST_CASE("where nobody knows any more where a line was it is where the map has it") {
  Servers servers;
  servers.run(0, 12 * term);
  for (const RegionId region : {first, second, third})
    servers.all[region.value] = Servers::made(region);
  servers.run(12 * term, 14 * term);
  CHECK(servers.line_m(first) == 0);
  CHECK(servers.line_m(third) == 0);
  servers.run(14 * term, 30 * term);
  CHECK(servers.line_m(first) == 32);
  CHECK(servers.line_m(third) == 32);
  CHECK(servers.all[first.value].margin_m() == 0);
}

TEST_CASE("whatever levels come, lines in a row lie within their bounds") {
  HomeLines lines = Servers::made(third);
  for (const int level : {0, 1, 2, 360, 32'767, 65'534, 65'535})
    for (const std::int64_t tick : {0L, 64L, 1'000'000'000L}) {
      const auto told = static_cast<std::uint16_t>(level);
      lines.hear(first, Tick{tick}, {.level = {told, told}, .level_below = told});
      lines.hear(second, Tick{tick}, {.level = {told, told}, .level_below = told, .gain = 1 << 30});
      lines.move(Tick{tick});
      CHECK(std::abs(lines.map().area(first).max_x + 75) <= 45);
      CHECK(std::abs(lines.map().area(second).max_x - 75) <= 45);
    }
}

TEST_CASE("a status says of lines what was put into it; a crowd of another size is refused") {
  const auto read = [](std::size_t bins) {
    flatbuffers::FlatBufferBuilder builder;
    const auto crowd = builder.CreateVector(std::vector<std::uint8_t>(bins, 48));
    wire::RegionStatusBuilder status(builder);
    status.add_awake(77);
    status.add_line_level(5);
    status.add_line_level_below(9);
    status.add_crowd_below(crowd);
    status.add_line_gain(-12);
    builder.Finish(status.Finish());
    return read_line_news(*flatbuffers::GetRoot<wire::RegionStatus>(builder.GetBufferPointer()));
  };
  const auto news = read(Crowd::bins);
  REQUIRE(news);
  CHECK(news->level == LoadLevels::Told{5, LoadLevels::unknown});
  CHECK(news->level_below == 9);
  CHECK(news->gain == -12);
  CHECK(news->awake == 77);
  CHECK(news->crowd_below.at(0) == Approx(4 * std::expm1(48 * std::log(1.05))));
  CHECK_FALSE(read(5));
}

namespace {

/// Three columns of 100 m, and twenty balls in each that fall from high up: in the first one within
/// 4 m of its line, which so has a quiet place 8 m further on.
WorldDefinition crowd_near_a_line() {
  WorldDefinition world = testing::flat_world(3, 100);
  for (int i = 0; i < 10; ++i)
    for (const double x : {97.0, 98.0, 150.0, 160.0, 250.0, 270.0})
      testing::put(world, testing::ball, {x, 300, 10.0 + 2 * i});
  return world;
}

}  // namespace

TEST_CASE("what rests where a line has gone is at home on the other side, and stays there") {
  WorldDefinition world = crowd_near_a_line();
  const BodyId box =
      testing::put(world, testing::box, {106, 0.5, -30}, {0, 0, 0}, Activation::asleep);
  testing::RegionCluster cluster(world, 1);
  for (int i = 0; i < 3; ++i) cluster.core(i).level_from(1);
  cluster.step(static_cast<int>(2 * term));
  CHECK(cluster.owner(box) == 1);
  cluster.step(static_cast<int>(3 * term));
  for (int i = 0; i < 3; ++i) {
    CHECK(cluster.core(i).home_lines().map().area(first).max_x == 108);
    CHECK(cluster.core(i).home_lines().margin_m() == 0);
  }
  CHECK(cluster.owner(box) == 0);
  cluster.step(2000);  // All has fallen, and rests or rolls.
  CHECK(cluster.owner(box) == 0);
  CHECK(cluster.bodies_in_world() == world.bodies.size());
  CHECK(cluster.faults().empty());
}

TEST_CASE("the wall of a region that is down stands where its line was, and where it goes") {
  WorldDefinition world = crowd_near_a_line();
  world.prototypes[testing::box.value].body.friction = 0;
  const BodyId from_left = testing::put(world, testing::box, {78, 0.5, -30}, {4, 0, 0});
  const BodyId from_right = testing::put(world, testing::box, {130, 0.5, -40}, {-4, 0, 0});
  testing::RegionCluster cluster(world, 1);
  for (int i = 0; i < 3; ++i) cluster.core(i).level_from(1);
  const auto line_m = [&](int seen_by) {
    return cluster.core(seen_by).home_lines().map().area(first).max_x;
  };
  cluster.step(400);
  REQUIRE(line_m(1) == 104);
  REQUIRE(cluster.owner(from_left) == 0);
  REQUIRE(cluster.owner(from_right) == 1);
  // To each of the two the other one is down.
  cluster.cut_link(0, 1);
  double left_m = 0, right_m = 200;
  for (int i = 0; i < 600; ++i) {
    cluster.step();
    left_m = std::max(left_m, cluster.state(from_left).position.x);
    right_m = std::min(right_m, cluster.state(from_right).position.x);
  }
  REQUIRE(line_m(1) == 108);
  CHECK(left_m == Approx(104).margin(0.1));
  // It was beyond the line when that came to 108 m, and has no more business where the other was.
  CHECK(right_m == Approx(104).margin(0.1));
}

TEST_CASE("the wall of a region that was down stands until it is heard of again") {
  WorldDefinition world = crowd_near_a_line();
  world.prototypes[testing::box.value].body.friction = 0;
  const BodyId comes = testing::put(world, testing::box, {78, 0.5, -30}, {4, 0, 0});
  testing::RegionCluster cluster(world, 1);
  for (int i = 0; i < 3; ++i) cluster.core(i).level_from(1);
  cluster.step(400);
  cluster.cut_link(0, 1);
  cluster.step(100);
  // There is a link again, and nobody at its other end who simulates.
  cluster.reset_link(0, 1);
  cluster.silence(1, 0);
  double farthest_m = 0;
  for (int i = 0; i < 500; ++i) {
    cluster.step();
    farthest_m = std::max(farthest_m, cluster.state(comes).position.x);
  }
  CHECK(farthest_m == Approx(104).margin(0.1));
}
