// Who gets what two servers contest where one has more to do than the other.
#include "server/aura/adaptive/contests/load_balance.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

TEST_CASE("the line is shifted towards who has more to do, both ways alike, and not for ever") {
  const double shift = line_shift_m({1010, 1}, {1000, 1});
  REQUIRE(shift > 0.5);
  REQUIRE(shift < 3);
  REQUIRE(line_shift_m({1000, 1}, {1010, 1}) == Approx(-shift));
  REQUIRE(line_shift_m({1000, 1}, {1000, 1}) == 0);
  REQUIRE(line_shift_m({1000, 1}, {100, 1}) == Approx(12));
  REQUIRE(line_shift_m({100, 1}, {1000, 1}) == Approx(-12));
}

TEST_CASE("the line is not shifted for so many bodies that the other one would have more to do") {
  REQUIRE(line_shift_m({1010, 10}, {1000, 1000}) > 0);
  REQUIRE(line_shift_m({1010, 11}, {1000, 0}) == 0);
  REQUIRE(line_shift_m({1000, 1000}, {1010, 10}) < 0);
  REQUIRE(line_shift_m({1000, 0}, {1010, 11}) == 0);
}

TEST_CASE("a server that has little to do, or says nothing, shifts no line") {
  REQUIRE(line_shift_m({128, 1}, {20, 1}) == Approx(12));
  REQUIRE(line_shift_m({127, 1}, {20, 1}) == 0);
  REQUIRE(line_shift_m({20, 1}, {128, 1}) == Approx(-12));
  REQUIRE(line_shift_m({20, 1}, {127, 1}) == 0);
  REQUIRE(line_shift_m({1000, 1}, {0, 1}) == 0);
  REQUIRE(line_shift_m({0, 1}, {1000, 1}) == 0);
}

TEST_CASE("of two sides that are held alike the one stays that makes servers more even") {
  // The larger one, while there is nothing to make even.
  for (const SideLoad even : {SideLoad{1000, 0}, SideLoad{1020, 0}, SideLoad{0, 0}}) {
    CHECK(stays({even.awake, 64}, {1000, 32}));
    CHECK_FALSE(stays({even.awake, 32}, {1000, 64}));
  }
  CHECK(stays({100, 64}, {20, 32}));
  // Who has more to do gives away the larger side, too, and gets nothing of it.
  CHECK_FALSE(stays({1200, 64}, {1000, 32}));
  CHECK(stays({1000, 32}, {1200, 64}));
  // But not so many that the other one has more to do by then than it had itself.
  CHECK(stays({1200, 512}, {1000, 32}));
  CHECK_FALSE(stays({1000, 32}, {1200, 512}));
}

TEST_CASE("the arbiter gives away what is held, too, while it has more to do") {
  Scene scene = both_changed_twice();
  REQUIRE(scene.decide().leaving.empty());
  scene.awake = {1000, 900};
  REQUIRE(scene.decide().leaving.size() == 1);
  scene.awake = {900, 1000};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.pulls[0].known == Company::Hold::changed_twice);
}

TEST_CASE("the arbiter gives away what lies on its own side while it has more to do") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.4)};
  scene.remote = {aura(1, 1, false, 10.1)};
  REQUIRE(scene.decide().leaving.empty());
  scene.awake = {1000, 900};
  const auto decision = scene.decide();
  REQUIRE(decision.pulls.empty());
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
}

TEST_CASE("the arbiter fetches what lies on the other side while it has less to do") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.9)};
  scene.remote = {aura(1, 1, false, 10.6)};
  REQUIRE(scene.decide().pulls.empty());
  scene.awake = {900, 1000};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
}

TEST_CASE("who has less to do keeps what lies no farther away than the line is shifted") {
  for (const double x : {13.0, 21.0, 23.0}) {
    for (const double theirs : {900.0, 1000.0, 1100.0}) {
      Scene scene;
      scene.hosted = {awake_at(0, x)};
      scene.awake = {1000, theirs};
      INFO("at " << x << " m, " << theirs << " awake there");
      REQUIRE(scene.decide().leaving.empty() == (theirs == 1100 && x < 22));
    }
  }
}

namespace {

/// Where three regions meet, seen by the second: one of each server meets the others'.
Scene corner() {
  Scene scene;
  scene.map = PartitionMap({{-inf, -inf, 10, 0}, {10, -inf, inf, 0}, {-inf, 0, inf, inf}});
  scene.self = 1;
  scene.hosted = {awake_at(1, 10.3, -0.3)};
  scene.remote = {aura(0, 0, false, 9.7, -0.3), aura(2, 2, false, 10, 0.2)};
  return scene;
}

}  // namespace

TEST_CASE("where three meet all go to the lowest while all are at the same level") {
  Scene scene = corner();
  for (const std::vector<double>& awake :
       {std::vector<double>{}, {500, 500, 500}, {900, 300, 300}, {300, 900, 900}}) {
    scene.awake = awake;
    const auto decision = scene.decide();
    REQUIRE(decision.leaving.size() == 1);
    REQUIRE(decision.leaving[0].to == RegionId{0});
  }
}

TEST_CASE("where three meet all go to the one at the lowest level") {
  Scene scene = corner();
  scene.levels = {5, 5, 4};
  REQUIRE(scene.decide().leaving.at(0).to == RegionId{2});
  REQUIRE(scene.decide().pulls.empty());
  scene.levels = {5, 4, 5};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 2);
  REQUIRE(decision.pulls[0].to == RegionId{1});
  REQUIRE(decision.pulls[1].to == RegionId{1});
}

TEST_CASE("of two servers the one at the lower level is the arbiter") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.9)};
  scene.remote = {aura(1, 1, false, 10.6)};
  REQUIRE(scene.decide().leaving.size() == 1);  // The middle lies at the other one's.
  scene.levels = {1, 0};
  REQUIRE(scene.decide().leaving.empty());
  scene.levels = {0, 1};
  REQUIRE(scene.decide().leaving.size() == 1);
}

TEST_CASE("what has come to the one that was first a second ago does not go on at once") {
  Scene scene = corner();
  scene.self = 2;
  scene.hosted = {awake_at(2, 10, 0.2)};
  scene.remote = {aura(0, 0, false, 9.7, -0.3), aura(1, 1, false, 10.3, -0.3)};
  scene.levels = {4, 5, 5};
  scene.levels_before = {5, 4, 5};
  REQUIRE(scene.decide().leaving.at(0).to == RegionId{0});
  scene.remote[1].company.changes = 1;
  REQUIRE(scene.decide().leaving.at(0).to == RegionId{1});
  SECTION("unless something has come to the one that is first now") {
    scene.remote[0].company.changes = 1;
    REQUIRE(scene.decide().leaving.at(0).to == RegionId{0});
  }
}

TEST_CASE("a decision that is asked says how many bodies hang together at most") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.9), awake_at(2, 9.5), awake_at(3, 2)};
  scene.hosted[0].velocity_mps = scene.hosted[1].velocity_mps = {0.2, 0, 0};
  REQUIRE(scene.decide().largest_cluster == 0);
  scene.asks_largest = true;
  REQUIRE(scene.decide().largest_cluster == 2);
}
