// A third server is near: who gets what meets then.
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

TEST_CASE("who has changed its owner does not go up where a third server may soon be near") {
  Scene scene;
  scene.map = PartitionMap({{-inf, -inf, -8, inf}, {-8, -inf, 20, inf}, {20, -inf, inf, inf}});
  scene.self = 1;
  scene.hosted = {awake_at(0, 19.9)};
  scene.remote = {aura(1, 2, false, 20.3)};
  for (const bool away : {false, true}) {
    scene.linked[0] = !away;
    scene.hosted[0].changed_owner = Tick{-1000};
    scene.remote[0].company.changes = 0;
    REQUIRE(scene.decide().leaving.size() == 1);
    scene.hosted[0].changed_owner = Tick{-10};
    scene.remote[0].company.changes = 1;
    REQUIRE(scene.decide().leaving.empty());
    REQUIRE(scene.decide().pulls.size() == 1);
  }
}

TEST_CASE("nothing is given to a higher number where a third server is near, or away but near") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {awake_at(0, 19.9)};
  scene.remote = {aura(1, 2, false, 20.3)};
  for (const double third_m : {30.0, 6.0})
    for (const bool away : {false, true}) {
      const double edge = 20 - third_m;
      scene.map =
          PartitionMap({{-inf, -inf, edge, inf}, {edge, -inf, 20, inf}, {20, -inf, inf, inf}});
      scene.linked[0] = !away;
      const MigrationDecision decision = scene.decide();
      INFO("a third server " << third_m << " m away, " << (away ? "down" : "up"));
      REQUIRE(decision.leaving.size() == (third_m < 10 ? 0 : 1));
      REQUIRE(decision.pulls.size() == (third_m < 10 ? 1 : 0));
    }
}

TEST_CASE("a body that meets two servers at a corner goes to the lowest one") {
  Scene scene;
  scene.map = columns(3);
  scene.self = 2;
  scene.hosted = {awake_at(0, 20.1)};
  scene.remote = {aura(1, 1, true, 19.6), aura(2, 0, true, 20.4)};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{0});
}

TEST_CASE("who has just changed its owner goes at once as far as it may have to") {
  Scene scene;
  scene.map = PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, 5, inf}, {5, -inf, inf, inf}});
  scene.self = 2;
  scene.hosted = {awake_at(0, 7)};  // 7 m from the lowest server's region.
  scene.remote = {aura(1, 1, false, 7.5)};
  REQUIRE(scene.decide().leaving.empty());  // The other one decides.
  scene.hosted[0].changed_owner = Tick{-long_stay_ticks + 1};
  REQUIRE(scene.decide().leaving[0].to == RegionId{0});
  scene.hosted[0].changed_owner = Tick{-long_stay_ticks};
  REQUIRE(scene.decide().leaving.empty());
}

TEST_CASE("who has been followed is not led on to a server that nobody meets yet") {
  Scene scene;
  scene.map = PartitionMap(
      {{-inf, -inf, 10, inf}, {10, -inf, 24, inf}, {24, -inf, 30, inf}, {30, -inf, inf, inf}});
  scene.self = 2;
  scene.hosted = {awake_at(0, 29.7)};
  scene.remote = {aura(1, 3, false, 30.3)};
  scene.remote[0].company.changes = 1;  // Region 1 is 6 m away: near for whoever has moved.
  auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.pulls[0].to == RegionId{2});
  // Where it meets something of that server's already, both go there.
  scene.remote.push_back(aura(2, 1, false, 29.1));
  decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
}
