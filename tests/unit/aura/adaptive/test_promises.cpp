// What has been asked for, or given, and is on its way: who waits for it, and for how long.
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

namespace {

/// Gives body 0 to region 1, whose body 4 it meets at z = 3 m; a decision later region 1 is asked
/// for its body 2, which meets body 1 at the same place.
void give_one_and_ask_for_another(Scene& scene, MigrationPolicy& policy) {
  scene.hosted = {awake_at(0, 9.9, 3)};
  scene.remote = {aura(4, 1, false, 10.5, 3)};
  REQUIRE(scene.decide(policy, Tick{0}).leaving.size() == 1);
  scene.hosted = {awake_at(1, 9.6, 3)};
  scene.remote = {aura(2, 1, false, 10.1, 3)};
  REQUIRE(scene.decide(policy, Tick{2}).pulls.size() == 1);
}

}  // namespace

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

TEST_CASE("what has changed twice since it was asked for was refused, and is met there") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6)};
  scene.remote = {aura(1, 1, false, 10.3)};
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
  scene.remote[0].company.changes = Company::changes_max;
  const auto decision = scene.decide(*policy, Tick{2});
  REQUIRE(decision.pulls.empty());
  REQUIRE(decision.leaving.size() == 1);
}

TEST_CASE("what was asked for by a side that had changed twice itself is not met halfway") {
  // That request is met at once.
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6)};
  scene.hosted[0].changed_owner = Tick{-3};
  scene.hosted[0].changed_owner_before = Tick{-62};
  scene.remote = {aura(1, 1, false, 10.3)};
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
  scene.remote[0].company.changes = Company::changes_max;
  for (const std::int64_t tick : {2, 4, 6}) {
    INFO("tick " << tick);
    const auto decision = scene.decide(*policy, Tick{tick});
    REQUIRE(decision.pulls.size() == 1);
    REQUIRE(decision.leaving.empty());
  }
  // It has not come, nor will it.
  REQUIRE(scene.decide(*policy, Tick{8}).leaving.size() == 1);
}

TEST_CASE("what is said to stay, since something has come to it, is not waited for") {
  // Its host refuses; what it does not say so of comes, and whoever went to meet it would swap
  // places with it.
  for (const bool lately : {false, true}) {
    INFO("something has come to it: " << lately);
    Scene scene;
    const auto policy = make_adaptive_policy(AuraTolerances{});
    give_one_and_ask_for_another(scene, *policy);
    scene.remote = {aura(0, 1, false, 10.1, 3.2), aura(2, 1, false, 10.1, 3)};
    for (RemoteAura& aura : scene.remote) aura.company.lately = lately;
    const auto decision = scene.decide(*policy, Tick{4});
    REQUIRE(decision.leaving.empty() == !lately);
    REQUIRE(decision.pulls.empty() == lately);
  }
}

TEST_CASE("what is asked for though it is said to stay is waited for: it comes") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6)};
  scene.hosted[0].changed_owner = Tick{-3};
  scene.hosted[0].changed_owner_before = Tick{-62};
  scene.remote = {aura(1, 1, false, 10.3)};
  scene.remote[0].company.lately = true;
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
  // Ours may go now, and the other one still stays by itself.
  scene.hosted[0].changed_owner = scene.hosted[0].changed_owner_before = Tick{-200};
  REQUIRE(scene.decide(*policy, Tick{2}).leaving.empty());
}

TEST_CASE("who meets what has been given goes there, while a cluster beside waits for what comes") {
  for (const std::int64_t tick : {4, 6}) {
    INFO("tick " << tick);
    Scene scene;
    const auto policy = make_adaptive_policy(AuraTolerances{});
    give_one_and_ask_for_another(scene, *policy);
    // A row of ours reaches from what is asked for to what was given, whose cluster goes on to
    // where it meets one more of ours.
    for (const double z : {3.6, 4.2, 4.8, 5.4, 6.0})
      scene.hosted.push_back(awake_at(static_cast<int>(10 * z), 9.6, z));
    scene.hosted.push_back(awake_at(5, 9.6, 12));
    scene.remote = {aura(0, 1, false, 10.1, 6), aura(2, 1, false, 10.1, 3),
                    aura(6, 1, false, 10.1, 12)};
    scene.remote[0].company.label = scene.remote[2].company.label = 8;
    scene.remote[1].company.label = 7;
    const auto decision = scene.decide(*policy, Tick{tick});
    REQUIRE(decision.leaving.size() == 1);
    REQUIRE(decision.leaving[0].bodies == std::vector{name(5)});
    // What the row meets has been asked for by now: one more that meets it waits.
    scene.hosted.back() = awake_at(7, 9.6, 12);
    REQUIRE(scene.decide(*policy, Tick{tick + 2}).leaving.empty());
  }
}

TEST_CASE("what has been given to the server that had it anyway joins nothing there") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.9)};
  scene.remote = {aura(1, 1, false, 10.5)};
  REQUIRE(scene.decide(*policy, Tick{0}).leaving.size() == 1);
  // One side has changed twice and asks for something of the same cluster there, which is met.
  scene.hosted = {awake_at(2, 9.6, 3)};
  scene.hosted[0].changed_owner = Tick{-3};
  scene.hosted[0].changed_owner_before = Tick{-61};
  scene.remote = {aura(1, 1, false, 12), aura(3, 1, false, 10.1, 3)};
  scene.remote[0].company.label = scene.remote[1].company.label;
  REQUIRE(scene.decide(*policy, Tick{2}).pulls.size() == 1);
  scene.remote[1].company.changes = Company::changes_max;
  REQUIRE(scene.decide(*policy, Tick{4}).leaving.empty());
}

TEST_CASE("what is asked for anew after it was left out is waited for as long as at first") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6, 3)};
  scene.hosted[0].changed_owner = Tick{-3};
  scene.hosted[0].changed_owner_before = Tick{-30};
  scene.remote = {aura(1, 1, false, 10.1, 3)};
  scene.remote[0].company.changes = Company::changes_max;
  for (const std::int64_t tick : {0, 6, 8})
    REQUIRE(scene.decide(*policy, Tick{tick}).pulls.size() == 1);
  // Ours may change its owner again, but the other one is on its way.
  scene.hosted[0].changed_owner_before = Tick{-100};
  const auto decision = scene.decide(*policy, Tick{10});
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
}

TEST_CASE("what is asked for by who knows now what it was refused for is waited for") {
  Scene scene;
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.6, 3)};
  scene.remote = {aura(1, 1, false, 10.1, 3)};
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
  // Both sides have changed twice meanwhile; ours stays.
  scene.hosted[0].changed_owner = Tick{1};
  scene.hosted[0].changed_owner_before = Tick{-30};
  scene.remote[0].company.changes = Company::changes_max;
  REQUIRE(scene.decide(*policy, Tick{2}).pulls.size() == 1);
  scene.hosted[0].changed_owner_before = Tick{-100};
  const auto decision = scene.decide(*policy, Tick{4});
  REQUIRE(decision.leaving.empty());
  REQUIRE(decision.pulls.size() == 1);
}

TEST_CASE("at a corner, too, what comes is waited for before all go to who has changed twice") {
  Scene scene;
  scene.map = PartitionMap({{-inf, -inf, 10, 0}, {10, -inf, inf, 0}, {-inf, 0, inf, inf}});
  const auto policy = make_adaptive_policy(AuraTolerances{});
  scene.hosted = {awake_at(0, 9.7, -0.3)};
  scene.remote = {aura(1, 1, false, 10.3, -0.3), aura(2, 2, false, 10, 0.2)};
  REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 2);
  // Its host has refused it, but may not do so again.
  scene.remote[1].company.changes = Company::changes_max;
  for (const std::int64_t tick : {2, 4, 6, 8}) {
    INFO("tick " << tick);
    const auto decision = scene.decide(*policy, Tick{tick});
    REQUIRE(decision.leaving.empty());
    REQUIRE(decision.pulls.size() == 2);
  }
  // Neither has come, nor will it.
  const auto decision = scene.decide(*policy, Tick{10});
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].to == RegionId{2});
}

TEST_CASE("what may have become part of what comes here is asked for too, not met halfway") {
  // By themselves the second two belong to the other side: if nothing near is on its way here.
  for (const double apart_m : {2.0, 10.0}) {
    const bool near = apart_m < 5;
    Scene scene;
    const auto policy = make_adaptive_policy(AuraTolerances{});
    scene.hosted = {awake_at(0, 9.6, 0), awake_at(1, 9.9, apart_m)};
    scene.remote = {aura(2, 1, false, 10.1, 0)};
    REQUIRE(scene.decide(*policy, Tick{0}).pulls.size() == 1);
    scene.remote.push_back(aura(3, 1, false, 10.3, apart_m));
    const auto decision = scene.decide(*policy, Tick{2});
    REQUIRE(decision.leaving.empty() == near);
    REQUIRE(decision.pulls.size() == 1);
    REQUIRE(decision.pulls[0].bodies.size() == (near ? 2u : 1u));
  }
}
