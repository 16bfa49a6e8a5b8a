// Aura projection's decisions, one look at a time: who goes, who is asked for, who is told.
#include <algorithm>

#include "server/aura/migration_policy.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Columns 10 m wide, from x = 0 on.
PartitionMap columns(int count) {
  std::vector<Rectangle> areas(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (i > 0) areas[i].min_x = 10.0 * static_cast<double>(i);
    if (i + 1 < areas.size()) areas[i].max_x = 10.0 * static_cast<double>(i + 1);
  }
  return PartitionMap(std::move(areas));
}

constexpr BodyId name(int n) {
  return BodyId::world(static_cast<std::uint32_t>(n));
}

HostedBody asleep_at(int n, double x, double z = 0) {
  HostedBody body;
  body.id = name(n);
  body.position = {x, 1, z};
  body.half_extents = {0.3, 0.3, 0.3};
  body.asleep = true;
  body.changed_owner = Tick{-1000};
  return body;
}

HostedBody awake_at(int n, double x, double z = 0) {
  HostedBody body = asleep_at(n, x, z);
  body.asleep = false;
  return body;
}

/// As another server would project such a body.
RemoteAura aura(int n, std::uint16_t host, bool asleep, double x, double z = 0) {
  return {name(n), RegionId{host}, {{x, 1, z}, {0.38, 0.38, 0.38}}, asleep};
}

struct Scene {
  PartitionMap map = columns(2);
  std::uint16_t self = 0;
  std::vector<HostedBody> hosted;
  std::vector<RemoteAura> remote;
  std::vector<HandoverRequest> requested;
  std::vector<bool> linked = std::vector<bool>(16, true);

  MigrationDecision decide() const {
    return make_adaptive_policy(AuraTolerances{})
        ->decide({Tick{0}, RegionId{self}, map, hosted, remote, requested, linked});
  }
};

std::vector<RegionId> told_of(const MigrationDecision& decision, BodyId id) {
  for (const auto& projected : decision.projected)
    if (projected.id == id) return projected.to;
  return {};
}

std::vector<RegionId> regions(std::initializer_list<int> numbers) {
  std::vector<RegionId> all;
  for (int n : numbers) all.push_back(RegionId{static_cast<std::uint16_t>(n)});
  return all;
}

}  // namespace

TEST_CASE("the arbiter asks for the other server's body, whichever of the two moves") {
  for (const bool ours_sleeps : {false, true})
    for (const bool theirs_sleeps : {false, true}) {
      Scene scene;
      scene.hosted = {ours_sleeps ? asleep_at(0, 9.8) : awake_at(0, 9.8)};
      scene.remote = {aura(1, 1, theirs_sleeps, 10.3)};
      const auto decision = scene.decide();
      REQUIRE(decision.leaving.empty());
      REQUIRE(decision.pulls.size() == 1);
      REQUIRE(decision.pulls[0].from == RegionId{1});
      REQUIRE(decision.pulls[0].bodies == std::vector{name(1)});
    }
}

TEST_CASE("the server that is not the arbiter waits, and tells the arbiter what it has there") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {asleep_at(0, 10.6)};  // Its own aura ends short of the boundary.
  scene.remote = {aura(1, 0, false, 10.1)};
  const auto decision = scene.decide();
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.empty());
  REQUIRE(told_of(decision, name(0)) == regions({0}));
  scene.remote.clear();
  REQUIRE(told_of(scene.decide(), name(0)).empty());
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
      REQUIRE(first.leaving.size() + high.decide().leaving.size() == 1);
    }
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
  // An unbroken cluster keeps 2 from going home.
  for (int n = 3; n < 30; ++n) scene.hosted.push_back(asleep_at(n, 9.7 + 0.6 * (n - 2)));
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
  scene.hosted = {asleep_at(0, 19.5), asleep_at(1, 20.1), asleep_at(2, 20.7)};
  REQUIRE(scene.decide().leaving[0].to == RegionId{2});
  scene.hosted = {asleep_at(0, 19.7), asleep_at(1, 20.3)};
  REQUIRE(scene.decide().leaving[0].to == RegionId{1});
}

TEST_CASE("an island that a projected aura touches stays until the two are together") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {asleep_at(0, 5)};
  scene.remote = {aura(1, 0, true, 5.5)};
  REQUIRE(scene.decide().leaving.empty());
  scene.remote.clear();
  REQUIRE(scene.decide().leaving.size() == 1);
}

TEST_CASE("an island waits before it goes home: half a second at rest, a second while it moves") {
  // Whoever moves may be met, and fetched back, the moment it has gone: two changes in a second.
  Scene scene;
  for (const std::int64_t ago : {stay_ticks - 1, stay_ticks, 2 * stay_ticks - 1, 2 * stay_ticks}) {
    scene.hosted = {asleep_at(0, 15)};
    scene.hosted[0].changed_owner = Tick{-ago};
    REQUIRE(scene.decide().leaving.empty() == (ago < stay_ticks));
    scene.hosted[0].asleep = false;
    REQUIRE(scene.decide().leaving.empty() == (ago < 2 * stay_ticks));
  }
}
