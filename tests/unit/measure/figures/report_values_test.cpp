// Numbers from reports: right ones from whole reports, none from broken ones.
#include "server/measure/figures/report_values.h"

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/unit/measure/figures/small_runs.h"

using namespace aureole;
using nlohmann::json;

TEST_CASE("what a report says is found where it stands") {
  const json report = small_run(Study::fig5, "adaptive", 2).report;
  CHECK(number_at(report, "bodies_lost") == 0);
  CHECK(number_at(report, "last_10_s/efficiency") == 0.95);
  CHECK(number_at(report, "total/wire/replica_key_share") == 0.25);
  CHECK(sum_of(report, "migrations") == 40);
  const auto frames = by_bucket(buckets_of(report), "worst_server_ms");
  REQUIRE(frames.size() == 4);
  CHECK(frames[3].t_s == 20);
  CHECK(frames[3].value == 10);
  CHECK(by_bucket(buckets_of(report, "ideal"), "worst_server_ms")[3].value == Approx(8.5));
  CHECK(median_server_ms(report) == Approx(8.75));
  CHECK(bytes_per_server_and_s(report) == Approx(4 * 2000 / 2.0 / 20));
  const auto parts = last_parts(report);
  REQUIRE(parts);
  CHECK(parts->total() == Approx(8.75));
  CHECK(parts->ms[0] == Approx(0.96 * 8.75));
  const auto bodies = bodies_by_server(buckets_of(report));
  REQUIRE(bodies.size() == 2);
  CHECK(bodies[1][3].value == 201);
}

TEST_CASE("the median is the middle server's, between the middle two of an even number") {
  json report = small_run(Study::weak, "adaptive", 4).report;
  for (json& bucket : report["buckets"]) bucket["server_ms"] = {1, 2, 4, 100};
  CHECK(median_server_ms(report) == 3);
  for (json& bucket : report["buckets"]) bucket["server_ms"] = {100, 1, 2};
  CHECK(median_server_ms(report) == 2);
  report["last_10_s"]["median_server_ms"] = 7;
  CHECK(median_server_ms(report) == 7);
  // Before the last two buckets there are two more.
  CHECK(median_server_ms_before(report) == 2);
  report["buckets"][0]["server_ms"] = {200, 3, 4};
  CHECK(median_server_ms_before(report) == 3);
  for (json& bucket : report["buckets"]) bucket.erase("server_ms");
  CHECK_FALSE(median_server_ms_before(report));
}

TEST_CASE("what is missing, null or of another kind is not there, and harms nothing") {
  const json whole = small_run(Study::fig5, "adaptive", 2).report;
  for (const json& wrong :
       {json(), json("x"), json::array({1}), json::object({{"a", 1}}), json(7)}) {
    CAPTURE(wrong.dump());
    CHECK_FALSE(number_at(wrong, "last_10_s/efficiency"));
    CHECK(buckets_of(wrong).empty());
    CHECK(buckets_of(wrong, "ideal").empty());
    CHECK_FALSE(median_server_ms(wrong));
    for (const auto& [name, value] : whole["buckets"][0].items()) {
      if (name == "t_end_s") continue;
      CAPTURE(name);
      json report = whole;
      for (json& bucket : report["buckets"]) bucket[name] = wrong;
      if (!wrong.is_number()) CHECK_FALSE(sum_of(report, name));
      bodies_by_server(buckets_of(report));
      last_parts(report);
      last_server_ms(report);
      bytes_per_server_and_s(report);
    }
  }
  json report = whole;
  report["buckets"][2]["migrations"] = nullptr;
  CHECK_FALSE(sum_of(report, "migrations"));
  CHECK(by_bucket(buckets_of(report), "migrations").size() == 3);
  report["buckets"][3]["split"].erase("decide");
  CHECK_FALSE(last_parts(report));
}
