// The adaptive mode's decisions, one look at a time: who goes, who is told, what a blow reaches.
#include <algorithm>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

TEST_CASE("whoever hosts something on the way of what moves here is told of it") {
  Scene scene;
  scene.map = columns(3);
  scene.self = 1;
  scene.hosted = {awake_at(0, 13)};
  scene.hosted[0].motion_speed_mps = 3;
  scene.remote = {aura(1, 2, true, 16)};
  REQUIRE(told_of(scene.decide(), name(0)).empty());
  scene.hosted[0].velocity_mps = {3, 0, 0};
  REQUIRE(told_of(scene.decide(), name(0)) == regions({2}));
}

TEST_CASE("a row stays whole while something is about to strike its far end") {
  for (const double gap : {0.6, 0.8}) {
    Scene scene;
    for (int n = 0; n < 6; ++n) scene.hosted.push_back(asleep_at(n, 10.5 + gap * n));
    const double last = scene.hosted.back().position.x;
    scene.hosted.push_back(awake_at(6, last + 1.5));
    scene.hosted[6].motion_speed_mps = 3;
    scene.hosted[6].velocity_mps = {-3, 0, 0};
    const auto decision = scene.decide();
    // Lying in contact it is one thing, with air between them each goes by itself.
    const bool first_leaves = !decision.leaving.empty() && decision.leaving[0].bodies[0] == name(0);
    REQUIRE(first_leaves == (gap > 0.7));
  }
}

TEST_CASE("what will be struck through a row of contacts goes along before the blow") {
  Scene scene;
  scene.self = 1;
  scene.hosted.push_back(awake_at(0, 16.4));
  scene.hosted[0].motion_speed_mps = 20;
  scene.hosted[0].velocity_mps = {-20, 0, 0};
  for (int n = 1; n <= 6; ++n) scene.hosted.push_back(asleep_at(n, 14.6 - 0.6 * n));
  scene.remote = {aura(9, 0, true, 10.4)};  // Touches the last one of the row.
  scene.requested = {{name(6), RegionId{0}}};
  REQUIRE(scene.decide().leaving[0].bodies.size() == 1);
  const Row row(1, 6);
  scene.contacts = &row;
  REQUIRE(scene.decide().leaving[0].bodies.size() == 7);
}

TEST_CASE("a blow that another server's body will give is passed on here") {
  Scene scene;
  const Row row(0, 3);
  scene.contacts = &row;
  for (int n = 1; n <= 4; ++n) scene.hosted.push_back(asleep_at(n, 9.6 - 0.6 * n));
  scene.remote = {aura(0, 1, false, 10.0)};
  REQUIRE(told_of(scene.decide(), name(4)).empty());
  scene.remote[0].speed_mps = 20;
  scene.remote[0].room.girth_m = 2;
  const auto decision = scene.decide();
  REQUIRE(decision.pulls.size() == 1);
  bool grown = false;
  for (const auto& projected : decision.projected)
    if (projected.id == name(4)) grown = !projected.resting && projected.speed_mps > 1;
  REQUIRE(grown);
}

TEST_CASE("a sleeper that leans harder than when it was cut counts as moving") {
  Scene scene;
  scene.hosted = {asleep_at(0, 9.6)};
  scene.remote = {aura(1, 1, true, 10.3)};
  REQUIRE(scene.decide().pulls.empty());
  scene.hosted[0].pressed = true;
  REQUIRE(scene.decide().pulls.size() == 1);
}

TEST_CASE("Bullet waking a heap does not make it move: what has been still for long rests") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.6)};
  scene.remote = {aura(1, 1, true, 10.3)};
  REQUIRE(scene.decide().pulls.size() == 1);
  scene.hosted[0].still_ticks = resting_ticks;
  REQUIRE(scene.decide().pulls.empty());
}

TEST_CASE("a cluster that is asked for goes whole, and nothing is fetched to the place it leaves") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.4, 0), asleep_at(1, 9.4, 0.6)};  // Two that touch.
  scene.remote = {aura(2, 1, false, 10.0, 1.1)};
  scene.requested = {{name(0), RegionId{1}}};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
  REQUIRE(decision.leaving[0].bodies == std::vector{name(0), name(1)});
  REQUIRE(decision.pulls.empty());
}

TEST_CASE("whoever is handed a body is told at once of what it leans on, until it has been heard") {
  // It would fall through it there until its new host has told of it, and been answered.
  for (const auto asleep : {Scene::Asleep::among_hosted, Scene::Asleep::apart}) {
    const auto policy = make_adaptive_policy(AuraTolerances{});
    Scene scene;
    scene.hosted = {asleep_at(0, 4), asleep_at(1, 4, 0.6)};
    REQUIRE(told_of(scene.decide(*policy, Tick{0}, asleep), name(1)).empty());
    scene.requested = {{name(0), RegionId{1}}};
    auto decision = scene.decide(*policy, Tick{2}, asleep);
    REQUIRE(decision.leaving.size() == 1);
    REQUIRE(decision.leaving[0].bodies == std::vector{name(0)});
    REQUIRE(told_of(decision, name(1)) == regions({1}));
    scene.requested.clear();
    scene.hosted.erase(scene.hosted.begin());
    const std::int64_t heard = 2 * hearing_ticks(AuraTolerances{});
    for (std::int64_t t = 2; t <= heard; t += decision_ticks)
      REQUIRE(told_of(scene.decide(*policy, Tick{2 + t}, asleep), name(1)) == regions({1}));
    REQUIRE(told_of(scene.decide(*policy, Tick{2 + heard + 10}, asleep), name(1)).empty());
  }
}

TEST_CASE("whoever is handed what rests is not told of what that does not lean on") {
  // What is told of becomes a stand-in, which wakes what touches it when it is taken back.
  Scene scene;
  scene.hosted = {asleep_at(0, 4), asleep_at(1, 4, 1.0)};
  scene.requested = {{name(0), RegionId{1}}};
  auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(told_of(decision, name(1)).empty());
  // What moves may lean on it by the time its new host has been heard.
  scene.hosted[0] = awake_at(0, 4);
  decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(told_of(decision, name(1)) == regions({1}));
}

TEST_CASE("what is carried belongs to its carrier's cluster, however far away it hangs") {
  Scene scene;
  scene.hosted = {awake_at(0, 9.4), awake_at(1, 4)};
  scene.hosted[1].leader = name(0);
  scene.requested = {{name(1), RegionId{1}}};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].bodies.size() == 2);
}

TEST_CASE("a request for a body that has moved on is nobody's loss") {
  Scene scene;
  scene.hosted = {asleep_at(0, 5)};
  scene.requested = {{name(7), RegionId{1}}};
  REQUIRE(scene.decide().leaving.empty());
}

TEST_CASE(
    "around a corner, servers that share no overlap with each other still hear of each other") {
  // The paper's case N, O: regions 0 and 1 side by side, 2 below both; 1 and 2 host something that
  // reaches into 0 only.
  Scene scene;
  scene.map = PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, inf, inf}});
  scene.self = 1;
  scene.hosted = {asleep_at(0, 0.3, -0.5)};
  REQUIRE(told_of(scene.decide(), name(0)) == regions({0, 2}));
}

TEST_CASE("what lies at home is told to those it reaches, what lies abroad to all around it too") {
  Scene scene;
  const auto column = [](double from, double to) { return Rectangle{from, -inf, to, inf}; };
  scene.map = PartitionMap({column(-inf, 0), column(0, 100), column(100, 200), column(200, inf)});
  scene.self = 1;
  scene.hosted = {asleep_at(0, 99.9), asleep_at(1, 100.1)};
  for (HostedBody& body : scene.hosted) body.changed_owner = Tick{-1};  // It does not go home yet.
  const auto decision = scene.decide();
  REQUIRE(told_of(decision, name(0)) == regions({2}));
  REQUIRE(told_of(decision, name(1)) == regions({0, 2, 3}));
  // Whoever has something so near may be handed what region 2 has there, and has to know by then.
  scene.remote = {aura(9, 3, true, 107)};
  REQUIRE(told_of(scene.decide(), name(0)) == regions({2, 3}));
}

TEST_CASE(
    "in a row, too, who does not know where others' lines are tells those who may be reached") {
  Scene scene;
  const auto column = [](double from, double to) { return Rectangle{from, -inf, to, inf}; };
  scene.map = PartitionMap({column(-inf, 0), column(0, 100), column(100, inf)});
  scene.self = 1;
  // So far from the line that nobody is near, and not too far for a line that lies elsewhere.
  scene.hosted = {awake_at(0, 80)};
  REQUIRE(scene.decide().projected.empty());
  scene.map_margin_m = 24;
  REQUIRE(told_of(scene.decide(), name(0)) == regions({2}));
}

TEST_CASE("what is far inside its region concerns nobody") {
  Scene scene;
  scene.hosted = {asleep_at(0, 5), awake_at(1, 2)};
  REQUIRE(scene.decide().projected.empty());
}

TEST_CASE("an aura further from home than the neighbours is told to everybody") {
  // Another server may host in that place too, as far from its own home: they must meet.
  Scene scene;
  scene.map = columns(6);
  scene.hosted = {asleep_at(0, 9.0), asleep_at(1, 9.7), asleep_at(2, 25)};
  // They have come too lately to go home at once.
  for (HostedBody& body : scene.hosted) body.changed_owner = Tick{-1};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(told_of(decision, name(2)) == regions({1, 2, 3, 4, 5}));
  REQUIRE(told_of(decision, name(1)) == regions({1, 2}));
}

TEST_CASE("an island stays while the way home is closed, and is still told to the others") {
  Scene scene;
  scene.map = columns(3);
  scene.hosted = {asleep_at(0, 15)};
  scene.linked[1] = false;
  auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(told_of(decision, name(0)) == regions({1, 2}));
  scene.linked[1] = true;
  decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
}

TEST_CASE(
    "an island over two regions goes to the one that holds most of it, on a tie to the lower") {
  Scene scene;
  scene.map = columns(3);
  scene.hosted = {awake_at(0, 19.4), awake_at(1, 20.1), awake_at(2, 20.7)};
  REQUIRE(scene.decide().leaving[0].to == RegionId{2});
  scene.hosted = {awake_at(0, 19.7), awake_at(1, 20.3)};
  REQUIRE(scene.decide().leaving[0].to == RegionId{1});
}

TEST_CASE("a heap that rests over a boundary is cut there: each body goes to its own region") {
  Scene scene;
  for (int n = 0; n < 6; ++n) scene.hosted.push_back(asleep_at(n, 9.25 + 0.5 * n));
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{1});
  REQUIRE(decision.leaving[0].bodies == std::vector{name(2), name(3), name(4), name(5)});
}

TEST_CASE("an island that a moving aura touches stays until the two are together") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {asleep_at(0, 5)};
  scene.remote = {aura(1, 0, false, 5.5)};
  scene.linked[0] = false;
  REQUIRE(scene.decide().leaving.empty());
  scene.linked[0] = true;
  REQUIRE(scene.decide().leaving.empty());  // The other one decides.
  scene.remote[0].host = RegionId{1};
  scene.self = 0;
  scene.hosted = {asleep_at(0, 15)};
  // Who decides gives it to the other one, which is where it is at home.
  scene.remote = {aura(1, 1, false, 15.5)};
  REQUIRE(scene.decide().leaving.size() == 1);
}

TEST_CASE(
    "whoever has come stays for a second, so that two changes of owner never follow closely") {
  Scene scene;
  for (const bool asleep : {false, true}) {
    // When nothing moves at all nobody will be fetched back, and everything must soon be home.
    const std::int64_t stay = asleep ? calm_stay_ticks : long_stay_ticks;
    for (const std::int64_t ago : {stay - 1, stay}) {
      scene.hosted = {asleep ? asleep_at(0, 15) : awake_at(0, 15)};
      scene.hosted[0].changed_owner = Tick{-ago};
      REQUIRE(scene.decide().leaving.empty() == (ago < stay));
    }
  }
}

TEST_CASE("what is near to a visitor is told to the region that the visitor lies in, too") {
  Scene scene;
  scene.map = columns(3);
  scene.self = 1;
  scene.hosted = {asleep_at(0, 10.45)};  // Its aura ends before the region does.
  for (const double x : {9.85, 10.9}) {
    scene.remote = {aura(1, 2, true, x)};
    const auto decision = scene.decide();
    REQUIRE(decision.projected.size() == 1);
    // It may go home to the first region from the third one, and lean on ours there.
    CHECK(decision.projected[0].to.contains(RegionId{0}) == (x < 10));
    CHECK(decision.projected[0].to.contains(RegionId{2}));
    CHECK_FALSE(decision.projected[0].to.contains(RegionId{1}));
  }
}
