// Who gets bodies that two servers must bring together: the arbiter's decisions, one look at a
// time.
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

TEST_CASE("the lower server asks for the other one's body unless both rest") {
  for (const bool ours_sleeps : {false, true})
    for (const bool theirs_sleeps : {false, true}) {
      Scene scene;
      scene.hosted = {ours_sleeps ? asleep_at(0, 9.6) : awake_at(0, 9.6)};
      scene.remote = {aura(1, 1, theirs_sleeps, 10.3)};
      const auto decision = scene.decide();
      REQUIRE(decision.leaving.empty());
      if (ours_sleeps && theirs_sleeps) {
        REQUIRE(decision.pulls.empty());
        continue;
      }
      REQUIRE(decision.pulls.size() == 1);
      REQUIRE(decision.pulls[0].from == RegionId{1});
      REQUIRE(decision.pulls[0].bodies == std::vector{name(1)});
    }
}

TEST_CASE("the higher server waits for the arbiter, and tells it of its side") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {asleep_at(0, 10.6)};  // Its own aura ends short of the boundary.
  for (const bool rests : {false, true}) {
    scene.remote = {aura(1, 0, rests, 10.1)};
    const auto decision = scene.decide();
    REQUIRE(decision.pulls.empty());
    REQUIRE(decision.leaving.empty());
    REQUIRE(told_of(decision, name(0)) == regions({0}));
  }
  scene.remote.clear();
  REQUIRE(told_of(scene.decide(), name(0)).empty());
}

TEST_CASE(
    "what would come with a body is told on while whatever was near it is being handed over") {
  Scene scene;
  scene.self = 1;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 10.3)};
  scene.hosted[0].changed_owner = Tick{-5};
  const std::vector<RemoteAura> near = {aura(1, 0, false, 9.4)};
  const auto told = [&](int tick) { return scene.decide(*policy, Tick{tick}).projected; };
  scene.remote = near;
  REQUIRE(told(0)[0].company.changes == 1);
  scene.remote = {};  // Its host has sent it on, and the next one's word is not here yet.
  for (int tick = 1; tick <= 4; ++tick) {
    INFO("tick " << tick);
    REQUIRE(told(tick)[0].company.changes == 1);
    REQUIRE(told(tick)[0].company.label != 0);
  }
  REQUIRE(told(20)[0].company.label == 0);
}

TEST_CASE("who was near is told on though somebody else is near now") {
  Scene scene;
  scene.map = columns(3);
  scene.self = 1;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {asleep_at(0, 15)};
  const auto told = [&](int tick) {
    const auto projected = scene.decide(*policy, Tick{tick}).projected;
    return projected.empty() ? RegionSet{} : projected[0].to;
  };
  scene.remote = {aura(1, 0, false, 14)};
  REQUIRE(told(0).contains(RegionId{0}));
  for (int tick = 2; tick <= 4; tick += 2) {
    scene.remote = {aura(2, 2, false, 16)};
    REQUIRE(told(tick).contains(RegionId{0}));
    REQUIRE(told(tick).contains(RegionId{2}));
  }
  REQUIRE(!told(20).contains(RegionId{0}));
}

TEST_CASE("the arbiter gives a pair to whoever's region its middle lies in") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.9)};
  scene.remote = {aura(1, 1, false, 10.3)};
  auto decision = scene.decide();
  REQUIRE(decision.pulls.empty());
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
  // Less of it would have to move the other way.
  for (int n = 2; n < 6; ++n) scene.hosted.push_back(awake_at(n, 9.9 - 0.5 * (n - 1)));
  decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
  // There are more of them than we see.
  scene.remote[0].company.size_class = 5;
  REQUIRE(scene.decide().leaving.size() == 1);
}

TEST_CASE("who has changed its owner more often stays where it is") {
  Scene scene;
  for (const bool ours : {false, true}) {
    scene.hosted = {awake_at(0, ours ? 9.9 : 9.6)};
    scene.remote = {aura(1, 1, false, 10.3)};
    REQUIRE(scene.decide().leaving.empty() == !ours);
    scene.hosted[0].changed_owner = Tick{ours ? -long_stay_ticks + 1 : -long_stay_ticks};
    scene.remote[0].company.changes = ours ? 0 : 1;
    REQUIRE(scene.decide().leaving.empty() == ours);
    // Twice is as often as it should.
    scene.hosted[0].changed_owner = Tick{-1};
    scene.hosted[0].changed_owner_before = Tick{ours ? -2 : -long_stay_ticks};
    scene.remote[0].company.changes = ours ? 1 : 2;
    REQUIRE(scene.decide().leaving.empty() == ours);
  }
}

TEST_CASE("of two sides that have both changed twice the larger one stays, for as long as asked") {
  Scene scene = both_changed_twice();
  const auto policy = make_adaptive_policy(AuraTolerances{});
  auto decision = scene.decide(*policy, Tick{0});
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.leaving.empty());
  // It has grown meanwhile: what has been asked for is on its way.
  scene.remote[0].company.size_class = 3;
  decision = scene.decide(*policy, Tick{2});
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.leaving.empty());
  decision = scene.decide();
  REQUIRE(decision.pulls.empty());
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
}

TEST_CASE("clusters that hang together through one of another server's get one verdict") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.9, 0), awake_at(1, 9.0, 3)};
  scene.remote = {aura(2, 1, false, 10.3, 0), aura(3, 1, false, 9.6, 3)};
  auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].bodies == std::vector{name(0)});
  REQUIRE(decision.pulls.size() == 1);
  for (RemoteAura& aura : scene.remote) aura.company.label = 7;
  decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.pulls[0].bodies.size() == 2);
}

TEST_CASE("clusters that meet the same body get one verdict") {
  Scene scene;
  // Of the first alone and it the middle lies beyond the boundary, of all three it does not.
  scene.hosted = {awake_at(0, 9.9, 0), awake_at(1, 8.0, 3)};
  scene.remote = {aura(2, 1, false, 10.3, 1.5)};
  scene.remote[0].room.girth_m = 2.5;
  scene.remote[0].company.label = 0;  // Its cluster is not known.
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
  REQUIRE(decision.pulls[0].bodies == std::vector{name(2)});
  scene.hosted.pop_back();
  REQUIRE(scene.decide().leaving.size() == 1);
}

TEST_CASE("both servers of a pair look at the same overlap and exactly one moves its body") {
  for (const bool ours_sleeps : {false, true})
    for (const bool theirs_sleeps : {false, true}) {
      Scene low, high;
      high.self = 1;
      low.hosted = {ours_sleeps ? asleep_at(0, 9.8) : awake_at(0, 9.8)};
      low.remote = {aura(1, 1, theirs_sleeps, 10.3)};
      high.hosted = {theirs_sleeps ? asleep_at(1, 10.3) : awake_at(1, 10.3)};
      high.remote = {aura(0, 0, ours_sleeps, 9.8)};
      const auto first = low.decide();
      for (const Pull& pull : first.pulls)
        for (BodyId id : pull.bodies) high.requested.push_back({id, RegionId{0}});
      const std::size_t moves = ours_sleeps && theirs_sleeps ? 0 : 1;
      REQUIRE(first.leaving.size() + high.decide().leaving.size() == moves);
    }
}
