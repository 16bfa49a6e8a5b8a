// Every scene in small, so that none rots. How long anything takes is not judged here.
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "server/bench/bench.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

BenchOptions tiny() {
  BenchOptions options;
  options.bodies = 120;
  options.seconds = 3;
  options.ticks = 6;
  options.repeats = 2;
  return options;
}

bool is_positive(const nlohmann::json& value) {
  return value.is_number() && std::isfinite(value.get<double>()) && value.get<double>() > 0;
}

}  // namespace

TEST_CASE("every scene of the bench comes to its end with figures for all that it measures") {
  std::set<std::string> operations;
  for (const BenchScene& scene : bench_scenes()) {
    const std::string name(scene.name);
    CAPTURE(name);
    const std::vector<BenchRow> rows = scene.run(tiny());
    const nlohmann::json json = json_of(scene, tiny(), rows);
    REQUIRE(json.at("bench") == scene.name);
    REQUIRE(json.at("options").at("bodies") == 120);
    REQUIRE_FALSE(json.at("results").empty());
    for (const auto& row : json.at("results")) {
      CAPTURE(row.dump());
      operations.insert(name + ": " + row.at("operation").get<std::string>());
      for (const char* key :
           {"bodies", "samples", "cpu_us_median", "cpu_us_p10", "cpu_us_p90", "cpu_us_per_body"})
        CHECK(is_positive(row.at(key)));
      CHECK(row.at("cpu_us_p10") <= row.at("cpu_us_median"));
      CHECK(row.at("cpu_us_median") <= row.at("cpu_us_p90"));
      CHECK(row.at("awake") <= row.at("bodies"));
      if (name == "replicas" || name == "handoff") CHECK(is_positive(row.at("bytes")));
      CHECK_FALSE(row.at("situation").get<std::string>().empty());
    }
    CHECK(table_of(rows).find("median µs") != std::string::npos);
  }
  CHECK(operations.size() >= 13);
}

TEST_CASE("the middle of what was measured, and its spread") {
  std::vector<double> samples;
  for (int i = 100; i >= 0; --i) samples.push_back(i);
  const Spread spread = spread_of(samples);
  CHECK(spread.median_us == 50);
  CHECK(spread.p10_us == 10);
  CHECK(spread.p90_us == 90);
}

TEST_CASE("a scene is found by its name") {
  REQUIRE(find_bench_scene("wire") != nullptr);
  CHECK(find_bench_scene("wire")->name == "wire");
  CHECK(find_bench_scene("wires") == nullptr);
}
