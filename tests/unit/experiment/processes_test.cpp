// Children that end well, die, or hang; and results that survive the pipe.
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "server/base/check.h"
#include "server/experiment/seed_processes.h"
#include "server/experiment/seed_result.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("work in child processes: what they return, how they die, and those that hang") {
  std::map<int, ChildOutcome> outcomes;
  run_in_processes(
      {4, 2, 1.0},
      [](int i) {
        if (i == 1) note_run_moment({312, 2, 140});
        if (i == 1) AUREOLE_CHECK(i == 0, "a broken invariant ends the child");
        if (i == 2) ::sleep(60);
        return std::string(i == 3 ? 200'000 : 3, 'x');
      },
      [&](int i, const ChildOutcome& outcome) { outcomes[i] = outcome; });
  REQUIRE(outcomes.size() == 4);
  REQUIRE(outcomes[0].ended_well);
  REQUIRE(outcomes[0].output == "xxx");
  REQUIRE_FALSE(outcomes[1].ended_well);
  REQUIRE(outcomes[1].how.find("a broken invariant ends the child") != std::string::npos);
  REQUIRE(outcomes[1].how.find("at tick 312, when r2 hosted 140 bodies") != std::string::npos);
  REQUIRE(outcomes[1].moment.tick == 312);
  REQUIRE(outcomes[2].moment.tick == -1);
  REQUIRE_FALSE(outcomes[2].ended_well);
  REQUIRE(outcomes[2].how.find("was not done after 1 s") != std::string::npos);
  REQUIRE(outcomes[3].output.size() == 200'000);
}

TEST_CASE("of two runs that differ the first step that does is told, with its tick and server") {
  SeedResult first, second;
  first.hash = 1;
  second.hash = 2;
  REQUIRE(tell_difference(first, second).tick == 0);
  first.trail = {{7, 0, 3, 11}, {7, 1, 5, 12}, {8, 0, 3, 13}};
  second.trail = first.trail;
  second.trail[1].hash = 99;
  second.trail[1].bodies = 4;
  const Violation told = tell_difference(first, second);
  REQUIRE(told.tick == 7);
  REQUIRE(told.what.find("r1's, with 5 bodies in the first run and 4") != std::string::npos);
  second.trail = {{7, 0, 3, 11}, {7, 1, 5, 12}};
  REQUIRE(tell_difference(first, second).tick == 8);
  REQUIRE(tell_difference(first, second).what.find("only the first run") != std::string::npos);
}

TEST_CASE("a seed's result comes back from JSON as it went in, and totals add up") {
  SeedResult result;
  result.seed = 0xffff'ffff'ffff'fff1u;
  result.scenario = "pour";
  result.bodies_lost = 3;
  result.migrations_per_body_max_per_s = 2;
  result.forced_changes = 7;
  result.foreign_hosted_share_max = 0.25;
  result.handoff_jumps_mm = {0.5, 1.5};
  result.hash = 0x8000'0000'0000'0001u;
  result.trail = {{7, 1, 5, 0x8000'0000'0000'0002u}};
  result.violations = {{"lost", 17, "a body is nowhere"}};
  const auto back = seed_result_from(nlohmann::json::parse(to_json(result).dump()));
  REQUIRE(back);
  REQUIRE(back->seed == result.seed);
  REQUIRE(back->hash == result.hash);
  REQUIRE(back->trail == result.trail);
  REQUIRE(back->violations.front().what == "a body is nowhere");

  RunTotals totals;
  totals.add(*back);
  totals.add(*back);
  const auto json = totals.to_json();
  REQUIRE(json["seeds"] == 2);
  REQUIRE(json["failed_seeds"] == 2);
  REQUIRE(json["bodies_lost"] == 6);
  REQUIRE(json["migrations_per_body_max_per_s"] == 2);
  REQUIRE(json["handoff_jump_mm_max"] == 1.5);
  REQUIRE_FALSE(seed_result_from(nlohmann::json{{"seed", 1}}));
}
