// Sleepers kept apart: found by place, and no decision depends on where they are kept.
#include "server/aura/sleepers.h"

#include <algorithm>
#include <random>
#include <vector>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

namespace {

std::vector<int> names(const Sleepers& sleepers, std::vector<Sleepers::Place> places) {
  std::vector<int> found;
  for (const Sleepers::Place place : places)
    found.push_back(static_cast<int>(sleepers.body(place).id.value - name(0).value));
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<int> found_in(Sleepers& sleepers, const AuraBox& box) {
  sleepers.settle();
  std::vector<Sleepers::Place> places;
  sleepers.rows().find(box, places);
  return names(sleepers, places);
}

/// Bodies touch that are nearer to each other than their shapes are wide.
class Touches final : public ContactSource {
 public:
  explicit Touches(const std::vector<HostedBody>& bodies) : bodies_(bodies) {}
  std::size_t find_touching(std::uint32_t slot, std::vector<std::uint32_t>& found) const override {
    found.clear();
    for (const HostedBody& body : bodies_)
      if (body.slot != slot && distance(body.position, bodies_[slot].position) < 0.7)
        found.push_back(body.slot);
    return found.size();
  }
  std::size_t slots() const override { return bodies_.size(); }
  BodyId body_in(std::uint32_t slot) const override { return bodies_[slot].id; }

 private:
  std::vector<HostedBody> bodies_;
};

/// A heap and some that fly into it, on both sides of a boundary.
Scene random_scene(std::mt19937& random) {
  std::uniform_real_distribution<double> along(-3, 3), across(4, 16), speed(-12, 12), chance(0, 1);
  Scene scene;
  scene.self = chance(random) < 0.5 ? 0 : 1;
  for (int n = 0; n < 120; ++n) {
    HostedBody body = asleep_at(n, across(random), along(random));
    body.round = chance(random) < 0.5;
    if (chance(random) < 0.1) {
      body.asleep = false;
      body.velocity_mps = {speed(random), 0, speed(random)};
      body.motion_speed_mps = body.velocity_mps.norm();
    }
    if (body.asleep && chance(random) < 0.05) body.pressed = true;
    body.changed_owner = Tick{chance(random) < 0.2 ? -20 : -1000};
    scene.hosted.push_back(body);
  }
  for (int n = 100; n < 110; ++n) {
    const bool asleep = chance(random) < 0.5;
    const auto host = static_cast<std::uint16_t>(1 - scene.self);
    RemoteAura remote = aura(n, host, asleep, across(random), along(random));
    if (!asleep) remote.speed_mps = std::abs(speed(random));
    remote.room.girth_m += asleep ? 0 : 1;
    scene.remote.push_back(remote);
  }
  if (chance(random) < 0.3) scene.requested = {{name(30), RegionId{0}, RegionId{0}}};
  return scene;
}

}  // namespace

TEST_CASE("sleepers are found by place as they come, move and go") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-40, 40), size(0.1, 6), chance(0, 1);
  Sleepers sleepers(columns(1).area(RegionId{0}));
  std::vector<HostedBody> here;
  for (int round = 0; round < 2000; ++round) {
    const int n = static_cast<int>(round % 500);
    std::erase_if(here, [&](const HostedBody& body) { return body.id == name(n); });
    if (chance(random) < 0.3) {
      sleepers.take(name(n));
    } else {
      HostedBody body = asleep_at(n, at(random), at(random));
      body.girth_m = chance(random) < 0.02 ? 30 : size(random);
      sleepers.put(body);
      here.push_back(body);
    }
    REQUIRE(sleepers.size() == here.size());
    if (round % 7 != 0) continue;
    AuraBox box{{at(random), 1, at(random)}, {size(random), 2, size(random)}};
    if (round % 70 == 0) box.half = {100, 2, 100};
    std::vector<int> expected;
    for (const HostedBody& body : here)
      if (resting_aura(body).box().overlaps(box))
        expected.push_back(static_cast<int>(body.id.value - name(0).value));
    std::sort(expected.begin(), expected.end());
    REQUIRE(found_in(sleepers, box) == expected);
  }
}

TEST_CASE("of sleepers in one place each can be taken by itself") {
  Sleepers sleepers(columns(1).area(RegionId{0}));
  const AuraBox here{{5, 1, 0}, {1, 1, 1}};
  for (int n = 0; n < 6; ++n) sleepers.put(asleep_at(n, 5));
  REQUIRE(found_in(sleepers, here).size() == 6);
  // All before the next settle().
  for (const int n : {0, 3, 1, 5}) REQUIRE(sleepers.take(name(n)));
  sleepers.put(asleep_at(3, 5));
  REQUIRE(found_in(sleepers, here) == std::vector{2, 3, 4});
  // Put again where it lay, and taken, between two settle()s.
  sleepers.put(asleep_at(3, 5));
  REQUIRE(sleepers.take(name(3)));
  REQUIRE(found_in(sleepers, here) == std::vector{2, 4});
}

TEST_CASE("who reaches out of the region is known without a search") {
  const PartitionMap map = columns(3);
  Sleepers sleepers(map.area(RegionId{1}));
  sleepers.put(asleep_at(0, 15));
  sleepers.put(asleep_at(1, 10.3));  // Its aura reaches 0.08 m further than itself.
  sleepers.put(asleep_at(2, 25));
  sleepers.put(asleep_at(3, 19.9));
  const auto beyond = [&] {
    return names(sleepers, {sleepers.beyond().begin(), sleepers.beyond().end()});
  };
  REQUIRE(beyond() == std::vector{1, 2, 3});
  sleepers.put(asleep_at(2, 15));
  REQUIRE(beyond() == std::vector{1, 3});
  REQUIRE(sleepers.take(name(1)));
  REQUIRE_FALSE(sleepers.take(name(1)));
  REQUIRE(beyond() == std::vector{3});
  // The region ends elsewhere: nobody is forgotten, and nobody stays who lies inside now.
  sleepers.put(asleep_at(1, 10.3));
  sleepers.move_home({10, -inf, 14, inf});
  REQUIRE(beyond() == std::vector{0, 1, 2, 3});
  sleepers.move_home({9, -inf, 30, inf});
  REQUIRE(beyond().empty());
  sleepers.move_home({12, -inf, 19, inf});
  REQUIRE(beyond() == std::vector{1, 3});
  REQUIRE(sleepers.take(name(3)));
  REQUIRE(beyond() == std::vector{1});
  REQUIRE(sleepers.take(name(1)));
  REQUIRE(sleepers.place_of(name(0)));
  REQUIRE_FALSE(sleepers.place_of(name(1)));
  // Who is gone is nowhere, also when the region ends elsewhere.
  sleepers.move_home({14, -inf, 19, inf});
  REQUIRE(beyond().empty());
  sleepers.move_home({16, -inf, 19, inf});
  REQUIRE(beyond() == std::vector{0, 2});
}

TEST_CASE("places farther away than any world are found and lost again") {
  Sleepers sleepers(columns(1).area(RegionId{0}));
  sleepers.put(asleep_at(0, 1e300));
  sleepers.put(asleep_at(1, 3, -1e300));
  sleepers.put(asleep_at(2, 3));
  REQUIRE(found_in(sleepers, {{3, 1, 0}, {1, 1, 1}}) == std::vector{2});
  for (int n = 0; n < 3; ++n) REQUIRE(sleepers.take(name(n)));
  REQUIRE(sleepers.size() == 0);
}

TEST_CASE("a decision is the same whether who sleeps is among the hosted bodies or apart") {
  std::mt19937 random(11);
  int deciding = 0;
  for (int round = 0; round < 300; ++round) {
    INFO("round " << round);
    Scene scene = random_scene(random);
    const Touches touches(scene.hosted);
    scene.contacts = &touches;
    const auto among = make_adaptive_policy(AuraTolerances{});
    const auto apart = make_adaptive_policy(AuraTolerances{});
    const auto require_same = [&](int tick) {
      INFO("tick " << tick);
      const auto expected = scene.decide(*among, Tick{tick});
      REQUIRE(is_same(expected, scene.decide(*apart, Tick{tick}, Scene::Asleep::apart)));
      deciding += expected.leaving.empty() && expected.pulls.empty() ? 0 : 1;
    };
    require_same(0);
    // What the looks before have left behind: visits that end, unrest, and then calm.
    scene.remote.clear();
    require_same(4);
    for (HostedBody& body : scene.hosted) body.asleep = true;
    for (const int tick : {8, 20, 40, 80}) require_same(tick);
  }
  REQUIRE(deciding > 300);
}

TEST_CASE("it is not calm yet where somebody has just fallen asleep") {
  for (const auto asleep : {Scene::Asleep::among_hosted, Scene::Asleep::apart}) {
    Scene scene;
    scene.hosted = {asleep_at(0, 12), awake_at(1, 5)};
    scene.hosted[0].changed_owner = Tick{-50};
    const auto policy = make_adaptive_policy(AuraTolerances{});
    REQUIRE(scene.decide(*policy, Tick{0}, asleep).leaving.empty());
    scene.hosted[1].asleep = true;
    REQUIRE(scene.decide(*policy, Tick{10}, asleep).leaving.empty());
    const auto calm = make_adaptive_policy(AuraTolerances{});
    REQUIRE(scene.decide(*calm, Tick{10}, asleep).leaving.size() == 1);
  }
}
