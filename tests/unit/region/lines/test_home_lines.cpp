// Where regions end: the same for all who have heard, and known to be uncertain by who has not.
#include "server/region/lines/home_lines.h"

#include <optional>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/grid_of_nine.h"
#include "tests/support/region_cluster.h"

using namespace aureole;

namespace {

constexpr std::int64_t term = LoadLevels::term_ticks, half = term / 2;
/// Lines follow levels half a term later.
constexpr std::int64_t later = half;
constexpr RegionId left{0}, right{1}, last{3};

/// Four regions around one corner.
PartitionMap corner() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, 0, inf}, {0, 0, inf, inf}});
}

/// The servers of a map, who tell each other at every sixteenth tick.
struct Servers {
  std::vector<HomeLines> all;
  std::vector<double> awake;

  /// Far less on the right: the line is asked to go as far as it may, at once.
  Servers() : Servers(corner(), {1000, 200, 1000, 200}) {}
  Servers(const PartitionMap& map, std::vector<double> loads) : awake(std::move(loads)) {
    for (std::uint16_t k = 0; k < map.size(); ++k)
      all.emplace_back(map, RegionId{k}, HomeLines::Rule::even_loads);
  }
  /// `deaf`: does not hear `silent`.
  void run(std::int64_t from, std::int64_t to, std::optional<RegionId> deaf = {},
           RegionId silent = left) {
    for (std::int64_t tick = from; tick < to; ++tick) {
      for (HomeLines& lines : all) lines.move(Tick{tick});
      if (tick % 16 == 0) tell(Tick{tick}, deaf, silent);
    }
  }
  void tell(Tick now, std::optional<RegionId> deaf, RegionId silent) {
    for (std::uint16_t k = 0; k < all.size(); ++k) {
      all[k].note_awake({}, awake);
      const LineNews told = all[k].tell(now, awake[k]);
      for (std::uint16_t other = 0; other < all.size(); ++other)
        if (other != k && !(deaf == RegionId{other} && silent == RegionId{k}))
          all[other].hear(RegionId{k}, now, told);
    }
  }
  double line_of(RegionId region) const { return all[region.value].map().area(left).max_x; }
};

}  // namespace

TEST_CASE("lines move for all servers at the same tick, a quarter of the way when a term begins") {
  Servers servers;
  servers.run(0, later);
  for (int n = 0; n < 6; ++n) {
    servers.run(later + n * term, later + n * term + 1);
    for (const RegionId region : {left, right, last}) {
      CHECK(servers.line_of(region) == -3 * std::min(n, 4));
      CHECK(servers.all[region.value].margin_m() == 0);
    }
    servers.run(later + n * term + 1, later + (n + 1) * term);
    CHECK(servers.line_of(left) == -3 * std::min(n, 4));
  }
}

TEST_CASE("who has not heard of a level keeps a margin, until it has") {
  Servers servers;
  servers.awake = {1000, 200, 500, 500};
  servers.run(0, half);
  servers.run(half, term + later + 1, right, left);
  CHECK(servers.line_of(left) == -3);
  CHECK(servers.line_of(right) == 0);
  // Lines may be 12 m to either side for somebody else.
  CHECK(servers.all[right.value].margin_m() == 24);
  CHECK(servers.all[left.value].margin_m() == 0);
  CHECK(servers.all[last.value].margin_m() == 0);
  servers.run(term + later + 1, term + later + 20);
  CHECK(servers.line_of(right) == -3);
  CHECK(servers.all[right.value].margin_m() == 0);
}

TEST_CASE("who never hears of a term keeps the margin for as long as lines depend on it") {
  Servers servers;
  servers.run(0, term + half);
  servers.run(term + half, 3 * term, right, left);
  servers.run(3 * term, 6 * term + later);
  CHECK(servers.all[right.value].margin_m() == 24);  // The second term counts until the sixth.
  servers.run(6 * term + later, 6 * term + later + 1);
  CHECK(servers.all[right.value].margin_m() == 0);
  CHECK(servers.line_of(right) == servers.line_of(left));
}

TEST_CASE("who has just started says of no level that it is in force, and others know it") {
  Servers servers;
  servers.run(0, 6 * term + 8);
  servers.all[left.value] = HomeLines(corner(), left, HomeLines::Rule::even_loads);
  HomeLines& anew = servers.all[left.value];
  CHECK(anew.tell(Tick{6 * term + 9}, 1000).level.now == LoadLevels::unknown);
  servers.run(6 * term + 9, 7 * term + later);
  CHECK(servers.line_of(right) == -12);
  CHECK(servers.line_of(last) == -12);
  servers.run(7 * term + later, 10 * term + later);
  CHECK(anew.margin_m() == 24);
  // Then it knows as much as anybody.
  servers.run(10 * term + later, 10 * term + later + 1);
  CHECK(anew.margin_m() == 0);
  CHECK(servers.line_of(left) == servers.line_of(right));
}

TEST_CASE("lines go on until all have as much, however far that is, and stay there") {
  Servers servers;
  const auto spread = [&] {  // The loads are even once the upper line lies 9 m further to the left.
    const double beyond_m = servers.line_of(left) + 9;
    servers.awake = {1000 + 10 * beyond_m, 1000 - 10 * beyond_m, 1000, 1000};
    return beyond_m;
  };
  double farthest_m = 0;
  for (int n = 0; n < 120; ++n) {
    farthest_m = std::min(farthest_m, spread());
    servers.run(n * term, (n + 1) * term);
    if (n >= 80) CHECK(std::abs(spread()) <= 1);
    CHECK(servers.all[last.value].map().area(RegionId{2}).max_x == 0);
  }
  CHECK(farthest_m > -3);  // It may overshoot by so much.
}

TEST_CASE("who has more neighbours than the others is left with fewer bodies, for it tells more") {
  Servers servers(testing::grid_of_nine(), std::vector<double>(9, 1000));
  servers.run(0, 20 * term);
  const Rectangle middle = servers.all[4].map().area(RegionId{4});
  CHECK(middle.max_x - middle.min_x < 118);
  CHECK(middle.max_z - middle.min_z < 120);
  servers.awake[4] = 980;  // Eight neighbours rather than five, and three at the corners.
  const auto upper = [&] { return servers.all[0].map().area(RegionId{0}).max_x; };
  const double before_m = upper();
  servers.run(20 * term, 60 * term);
  const Rectangle now = servers.all[4].map().area(RegionId{4});
  CHECK(now.max_x - now.min_x > middle.max_x - middle.min_x);
  CHECK(upper() > before_m);  // The four at the corners may have more.
}

TEST_CASE("lines follow what lasts: not the blow that wakes a heap for a moment") {
  Servers servers;
  servers.awake = {1000, 1000, 1000, 1000};
  servers.run(0, 12 * term);
  servers.awake = {2000, 1000, 2000, 1000};
  servers.run(12 * term, 12 * term + half);
  servers.awake = {1000, 1000, 1000, 1000};
  servers.run(12 * term + half, 13 * term + 1);
  CHECK(std::abs(servers.line_of(left)) <= 3);
  servers.run(13 * term + 1, 60 * term);
  CHECK(std::abs(servers.line_of(left)) < 1);
}

TEST_CASE("where it has calmed down lines do not move again for what wakes for a moment") {
  for (const std::int64_t waking_ticks : {500, 1500}) {
    Servers servers;
    servers.run(0, 5 * term);
    servers.awake = {0, 0, 0, 0};
    servers.run(5 * term, 10 * term);
    REQUIRE(servers.line_of(left) == 0);
    servers.awake = {1000, 200, 1000, 200};
    servers.run(10 * term, 10 * term + waking_ticks);
    servers.awake = {0, 0, 0, 0};
    double longest_m = 0;
    for (std::int64_t tick = 10 * term + waking_ticks; tick < 30 * term; ++tick) {
      servers.run(tick, tick + 1);
      longest_m = std::max(longest_m, std::abs(servers.line_of(left)));
    }
    CHECK((waking_ticks < 600 ? longest_m == 0 : longest_m > 0));
  }
}

TEST_CASE("a world that has calmed down ends where the map says, within five terms") {
  Servers servers;
  servers.run(0, 5 * term);
  REQUIRE(servers.line_of(left) == -12);
  CHECK_FALSE(servers.all[left.value].settled());
  servers.awake = {0, 0, 0, 0};
  servers.run(5 * term, 9 * term + later + 1);
  CHECK(servers.line_of(left) == 0);
  CHECK(servers.all[left.value].settled());
}

TEST_CASE("lines are not settled while something is known that will move them") {
  Servers servers;
  HomeLines& lines = servers.all[left.value];
  CHECK(lines.settled());
  servers.run(0, 1);
  CHECK_FALSE(lines.settled());  // There is a load, though no level has been chosen yet.
  servers.awake = {100, 100, 100, 100};
  for (HomeLines& each : servers.all) each = HomeLines(corner(), left, HomeLines::Rule::even_loads);
  lines.hear(right, Tick{half}, {.level = {0, 300}});
  CHECK_FALSE(lines.settled());  // Its neighbour will have.
}

TEST_CASE("lines that do not move tell nothing and fear nothing") {
  HomeLines lines(corner(), left, HomeLines::Rule::still);
  lines.note_awake({}, std::vector<double>{5000, 10, 10, 10});
  CHECK(lines.tell(Tick{half}, 5000).level == LoadLevels::Told{});
  lines.hear(right, Tick{half}, {.level = {0, 9000}});
  CHECK_FALSE(lines.move(Tick{10 * term}));
  CHECK(lines.margin_m() == 0);
  CHECK(lines.map().area(left) == corner().area(left));
}

TEST_CASE("whatever levels come, lines lie within their bounds") {
  HomeLines lines(corner(), left, HomeLines::Rule::even_loads);
  for (const int level : {0, 1, 32'767, 65'534, 65'535})
    for (const std::int64_t tick : {0L, 64L, 1'000'000'000L}) {
      const auto told = static_cast<std::uint16_t>(level);
      lines.hear(right, Tick{tick}, {.level = {told, told}});
      lines.move(Tick{tick});
      CHECK(std::abs(lines.map().area(left).max_x) <= 12);
    }
}

TEST_CASE("what rests near the line goes to the neighbour who has less to do, and home again") {
  // Two regions on the right, and balls that fall from high up, most of them on the left.
  WorldDefinition world = testing::flat_world(2);
  RegionDefinition third = world.regions[1];
  third.name = "third";
  third.area.min_z = world.regions[1].area.max_z = 0;
  world.regions.push_back(third);
  for (int i = 0; i < 24; ++i)
    testing::put(world, testing::ball, {5.0 + 2 * (i % 4), 300.0, -10.0 - 2 * (i / 4)});
  for (int i = 0; i < 8; ++i)  // One server has three times as much to do as each of the others.
    testing::put(world, testing::ball, {80.0 + 2 * (i % 4), 300.0, i < 4 ? -20.0 : 20.0});
  const BodyId box =
      testing::put(world, testing::box, {45, 0.5, -30}, {0, 0, 0}, Activation::asleep);
  testing::RegionCluster cluster(world, 1);
  for (int i = 0; i < 3; ++i) cluster.core(i).level_from(1);
  cluster.step(static_cast<int>(term));
  CHECK(cluster.owner(box) == 0);
  cluster.step(static_cast<int>(2 * term + later));  // By then it is 6 m further to the left.
  CHECK(cluster.owner(box) == 1);
  CHECK(cluster.faults().empty());
  cluster.step(2000);
  CHECK(cluster.owner(box) == 0);
  CHECK(cluster.faults().empty());
}
