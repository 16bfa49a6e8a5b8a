// Who goes home, with whom, and what holds them back.
#include "server/aura/adaptive/outlook/aura_size.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

namespace {

HostedBody moving_at(int n, double x, double speed_mps, double z = 0) {
  HostedBody body = awake_at(n, x, z);
  body.velocity_mps = {speed_mps, 0, 0};
  body.motion_speed_mps = std::abs(speed_mps);
  return body;
}

std::vector<BodyId> going_home(const Scene& scene) {
  const auto decision = scene.decide();
  return decision.leaving.empty() ? std::vector<BodyId>{} : decision.leaving[0].bodies;
}

std::vector<BodyId> names(std::initializer_list<int> numbers) {
  std::vector<BodyId> all;
  for (int n : numbers) all.push_back(name(n));
  return all;
}

}  // namespace

TEST_CASE("what will soon meet goes home together or not at all") {
  Scene scene;
  // Half a second apart, too far to be one cluster.
  scene.hosted = {moving_at(0, 13, 4), asleep_at(1, 15)};
  REQUIRE(going_home(scene) == names({0, 1}));
  scene.hosted[1].changed_owner = Tick{-10};  // It has just come.
  REQUIRE(going_home(scene).empty());
  scene.hosted[0] = moving_at(0, 13, -0.5);  // Away from it.
  REQUIRE(going_home(scene) == names({0}));
}

TEST_CASE("who was born abroad stays until news of it has come and gone") {
  Scene scene;
  const std::int64_t news_ticks = verdict_hold_ticks(AuraTolerances{});
  for (const std::int64_t ago : {std::int64_t{0}, news_ticks - 1, news_ticks}) {
    scene.hosted = {moving_at(0, 13, 4)};
    scene.hosted[0].came = Tick{-ago};
    REQUIRE(going_home(scene) == (ago < news_ticks ? names({}) : names({0})));
  }
}

TEST_CASE("what will soon meet something of its host's own region stays") {
  for (const double speed : {-1.0, -6.0}) {
    Scene scene;
    scene.hosted = {asleep_at(0, 9), moving_at(1, 11.5, speed)};
    REQUIRE(going_home(scene) == (speed < -2 ? names({}) : names({1})));
  }
}

TEST_CASE("what moves at home holds nobody back, what a third server has does") {
  for (const std::uint16_t host : {std::uint16_t{1}, std::uint16_t{2}}) {
    for (const bool asleep : {false, true}) {
      Scene scene;
      scene.map = columns(3);
      scene.hosted = {moving_at(0, 13, 4)};
      scene.remote = {aura(1, host, asleep, 15)};
      REQUIRE(going_home(scene) == (host == 1 ? names({0}) : names({})));
    }
  }
}

TEST_CASE("what rests goes home beside what moves there, not beside what moves with a third") {
  for (const std::uint16_t host : {std::uint16_t{1}, std::uint16_t{2}}) {
    Scene scene;
    scene.map = columns(3);
    scene.hosted = {asleep_at(0, 13)};
    scene.remote = {aura(1, host, false, 14)};
    REQUIRE(going_home(scene) == (host == 1 ? names({0}) : names({})));
  }
}

TEST_CASE("what goes home does not pass by what has been asked for") {
  for (const bool asked : {false, true}) {
    INFO("it comes here: " << asked);
    Scene scene;
    // Body 1 comes to body 0, or that goes to it; 2 is met by what moves of body 1 soon.
    scene.hosted = {awake_at(0, asked ? 9.6 : 9.9), asleep_at(2, 11.4)};
    scene.remote = {aura(1, 1, false, 10.3)};
    REQUIRE(scene.decide().pulls.size() == (asked ? 1 : 0));
    REQUIRE(going_home(scene) == (asked ? names({}) : names({0, 2})));
  }
}

TEST_CASE("a pile stays whole while any of it settles, a layer on the ground does not wait") {
  for (const bool piled : {false, true}) {
    Scene scene;
    for (int n = 0; n < 4; ++n) {
      scene.hosted.push_back(asleep_at(n, 12 + 0.6 * n));
      scene.hosted.back().ground_gap_m = piled && n % 2 == 1 ? 0.5 : 0;
    }
    // It has just come, and is slow; who is next to it will be struck.
    scene.hosted.push_back(awake_at(4, 12 + 0.6 * 3 + 0.75));
    scene.hosted.back().motion_speed_mps = 0.2;
    scene.hosted.back().changed_owner = Tick{-10};
    REQUIRE(going_home(scene) == (piled ? names({}) : names({0, 1})));
  }
}
