// What a whole gateway says of its regions: `/healthz` and `/api/status`.
#include "tests/unit/gateway/support/running_gateway.h"

using namespace aureole;
using namespace aureole::test;

TEST_CASE("A tolerance that a region does not keep is in the status with its peer and its tick") {
  FakeRegion west(world(), {.id = RegionId{0},
                            .bodies = 1,
                            .outside = {{625, 5.25, 2, 1, 1}, {630, 40, 32, 0, 0}},
                            .missed_blows = 3});
  // One that cannot be: there is no region 7. It costs the link, and nobody else anything.
  FakeRegion east(world(), {.id = RegionId{1}, .outside = {{625, 5.25, 2, 7, 1}}});
  RunningGateway gateway({west.address(), east.address()});
  RunningGateway::wait_for([&] { return !gateway.status()["regions"][0]["outside"].empty(); });
  const Json region = gateway.status()["regions"][0];
  REQUIRE(region["tolerance_events"] == 2);
  REQUIRE(region["missed_blows"] == 3);
  const Json latency = {{"tolerance", "latency"}, {"peer", "east"}, {"since_tick", 625},
                        {"value", 5.25},          {"limit", 2.0},   {"unit", "ms"}};
  REQUIRE(region["outside"][0] == latency);
  REQUIRE(region["outside"][1]["tolerance"] == "speed");
  REQUIRE(region["outside"][1]["peer"].is_null());
  RunningGateway::wait_for([&] { return gateway.status()["regions"][1]["up"] == false; });
  REQUIRE(gateway.status()["regions"][1]["outside"].empty());
}

TEST_CASE("Health and status say which regions are there and what they report") {
  FakeRegion west(world(), {.id = RegionId{0}, .bodies = 5});
  FakeRegion absent(world(), {.id = RegionId{1}});
  PeerAddress nobody = absent.address();
  nobody.at.port = 1;  // nothing listens there
  RunningGateway gateway({west.address(), nobody});
  RunningGateway::wait_for([&] { return gateway.get("/healthz").body == "missing: east\n"; });
  REQUIRE(gateway.get("/healthz").status == 503);
  RunningGateway::wait_for([&] { return gateway.status()["bodies"] == 5; });
  const Json status = gateway.status();
  REQUIRE(status["world_time_s"].is_number());
  REQUIRE(status["players"] == 0);
  REQUIRE(status["complete"] == false);
  REQUIRE(status["regions"].size() == 2);
  REQUIRE(status["regions"][0]["name"] == "west");
  REQUIRE(status["regions"][0]["up"] == true);
  REQUIRE(status["regions"][1]["up"] == false);
  for (const char* key : {"bodies", "awake", "frame_ms_p50", "frame_ms_max", "migrations_in",
                          "migrations_out", "overruns", "skipped_ticks", "whole_looks"})
    REQUIRE(status["regions"][0][key].is_number());

  REQUIRE(status["regions"][0]["outside"].empty());

  // A new player needs the region of the spawn point only; one who may be anywhere has to wait.
  ViewClientOptions o;
  o.gateway = gateway.at;
  ViewClient fresh(o);
  REQUIRE(fresh.connect());
  (void)welcome_of(fresh);
  o.token = "0123456789abcdef0123456789abcdef";
  ViewClient returning(o);
  REQUIRE(returning.connect());
  REQUIRE(fresh.wait_for_pictures(fresh.pictures() + 30));
  REQUIRE_FALSE(returning.wait_for_text("\"welcome\"", 0.1));
}

TEST_CASE("Boundaries are drawn where regions end now, by what their servers say of their loads") {
  const WorldDefinition corner = small_world_with_corner();
  struct Pictures {
    std::string with, without;  ///< Boundaries.
  };
  // With boundaries until it is another one than `other`, for as long as a busy machine may take.
  const auto pictures = [&](std::uint16_t west_level, const std::string& other) {
    std::vector<std::unique_ptr<FakeRegion>> regions;
    std::vector<PeerAddress> at;
    for (std::uint16_t k = 0; k < 4; ++k) {
      const std::uint16_t level = k % 2 == 0 ? west_level : 400;
      regions.push_back(std::make_unique<FakeRegion>(
          corner, FakeRegion::Options{.id = RegionId{k}, .bodies = 1, .line_level = level}));
      at.push_back(regions.back()->address());
    }
    RunningGateway gateway(at, 8, corner);
    gateway.wait_until_healthy();
    const auto frame = [&](const std::string& options) {
      const auto answer = gateway.get(
          "/api/frame.jpg?x=0&y=30&z=40&yaw=0&pitch=-0.6&w=320&h=180&format=ppm" + options);
      REQUIRE(answer.status == 200);
      return answer.body;
    };
    std::string with;
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    do {
      // All say how much they have to do at every sixteenth tick.
      std::this_thread::sleep_for(std::chrono::milliseconds(600));
      with = frame("&boundaries=1");
    } while (with == other && std::chrono::steady_clock::now() < until);
    return Pictures{with, frame("")};
  };
  // 1.0025^400 is 2.7, 1.0025^900 is 9.5: the line between west and east goes west.
  const Pictures even = pictures(400, ""), again = pictures(400, ""),
                 west = pictures(900, even.with);
  // Compared here, not by CHECK(), which would print them.
  const bool same = again.with == even.with;
  const bool moved = west.with != even.with;
  const bool only_boundaries = west.without == even.without;
  CHECK(same);
  CHECK(moved);
  CHECK(only_boundaries);
}
