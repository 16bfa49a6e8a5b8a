// The adaptive mode's decisions, one look at a time: who goes, who is asked for, who is told.
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
  body.bounding_radius_m = body.girth_m = 0.3;
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
  RemoteAura remote{name(n), RegionId{host}, {{x, 1, z}, {0, 0, 0}, 0.38}, asleep};
  remote.resting = asleep;
  remote.speed_mps = asleep ? 0 : 0.2;
  return remote;
}

/// Bodies in a row of contacts, by their places among those hosted.
class Row final : public ContactSource {
 public:
  Row(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t n = first; n <= last; ++n) {
      partners_.resize(n + 1);
      if (n == first) continue;
      partners_[n].push_back(n - 1);
      partners_[n - 1].push_back(n);
    }
  }
  std::span<const std::uint32_t> touching(std::uint32_t body) const override {
    return body < partners_.size() ? std::span(partners_[body]) : std::span<const std::uint32_t>{};
  }
  std::size_t leaning_on(std::uint32_t body) const override { return touching(body).size(); }

 private:
  std::vector<std::vector<std::uint32_t>> partners_;
};

struct Scene {
  PartitionMap map = columns(2);
  std::uint16_t self = 0;
  std::vector<HostedBody> hosted;
  std::vector<RemoteAura> remote;
  std::vector<HandoverRequest> requested;
  std::vector<bool> linked = std::vector<bool>(16, true);
  const ContactSource* contacts = nullptr;

  MigrationDecision decide(MigrationPolicy& policy, Tick now) const {
    return policy.decide({now, RegionId{self}, map, hosted, remote, requested, linked, contacts});
  }
  MigrationDecision decide() const {
    return decide(*make_adaptive_policy(AuraTolerances{}), Tick{0});
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

TEST_CASE("what the arbiter has asked for is not met halfway") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6)};
  scene.remote = {aura(1, 1, false, 10.3)};
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
  scene.hosted[0].position.x = 9.9;  // The middle is on the other side now.
  REQUIRE(scene.decide(*policy, Tick{1}).leaving.empty());
  REQUIRE(scene.decide(*policy, Tick{20}).leaving.size() == 1);
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

TEST_CASE("a request by the server that has just handed the cluster over is out of date") {
  Scene scene;
  scene.self = 1;
  scene.hosted = {asleep_at(0, 10.6)};
  scene.hosted[0].came_from = RegionId{1};
  scene.requested = {{name(0), RegionId{0}}};
  REQUIRE(scene.decide().leaving.size() == 1);
  scene.hosted[0].changed_owner = Tick{-3};
  REQUIRE(scene.decide().leaving.size() == 1);
  scene.hosted[0].came_from = RegionId{0};
  scene.hosted[0].changed_owner = Tick{-30};
  REQUIRE(scene.decide().leaving.size() == 1);
  scene.hosted[0].changed_owner = Tick{-3};
  REQUIRE(scene.decide().leaving.empty());
}

TEST_CASE("nothing is given to a higher number where a third server is near") {
  Scene scene;
  scene.map = columns(3);
  scene.self = 1;
  scene.hosted = {awake_at(0, 19.9)};
  scene.remote = {aura(1, 2, false, 20.3)};
  REQUIRE(scene.decide().leaving.size() == 1);
  scene.map = PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, 7, inf}, {7, -inf, inf, inf}});
  scene.hosted = {awake_at(0, 6.9)};
  scene.remote = {aura(1, 2, false, 7.3)};
  REQUIRE(scene.decide().leaving.empty());
  REQUIRE(scene.decide().pulls.size() == 1);
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
  scene.map = columns(3);
  scene.self = 2;
  scene.hosted = {awake_at(0, 13)};  // Three metres from the lowest server's region.
  scene.remote = {aura(1, 1, false, 13.5)};
  REQUIRE(scene.decide().leaving.empty());  // The other one decides.
  scene.hosted[0].changed_owner = Tick{-long_stay_ticks + 1};
  REQUIRE(scene.decide().leaving[0].to == RegionId{0});
  scene.hosted[0].changed_owner = Tick{-long_stay_ticks};
  REQUIRE(scene.decide().leaving.empty());
}

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
