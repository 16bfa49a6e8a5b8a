// Small runs of every mode: the report is whole, bodies agree, and the same seed is the same run.
#include "server/measure/experiment.h"

#include <set>

#include "tests/support/catch.h"

using namespace aureole;
using nlohmann::json;

namespace {

ExperimentOptions small(const std::string& mode) {
  ExperimentOptions options;
  options.workload.layout = "corner";
  options.workload.servers = 4;
  options.workload.seconds = 3;
  options.workload.rate_per_s = 60;
  options.workload.seed = 7;
  options.mode = mode;
  return options;
}

json run(const ExperimentOptions& options) {
  auto report = run_experiment(options, [](const std::string&) {});
  REQUIRE(report);
  return *report;
}

std::uint64_t bodies_at_end(const json& report) {
  std::uint64_t sum = 0;
  for (const json& count : report["buckets"].back()["bodies"]) sum += count.get<std::uint64_t>();
  return sum;
}

/// Without what is different each time.
json without_times(const json& value) {
  static const std::set<std::string> times = {"max_frame_ms",     "worst_server_ms",
                                              "p99_frame_ms",     "split",
                                              "server_ms",        "frames_in_tolerance_share",
                                              "speedup",          "efficiency",
                                              "efficiency_ideal", "last_10_s"};
  json rest = value;
  if (value.is_object())
    for (const std::string& name : times) rest.erase(name);
  for (json& part : rest)
    if (part.is_structured()) part = without_times(part);
  return rest;
}

const char* const every_mode[] = {"single", "naive", "paper", "adaptive", "ideal", "cut"};

}  // namespace

TEST_CASE("every mode's report has every field, and all of its bodies") {
  for (const std::string mode : every_mode) {
    CAPTURE(mode);
    const json report = run(small(mode));
    const bool talks = mode == "naive" || mode == "paper" || mode == "adaptive";
    REQUIRE(report["buckets"].size() == 1);
    const json& bucket = report["buckets"][0];
    for (const char* field :
         {"t_end_s", "max_frame_ms", "worst_server_ms", "p99_frame_ms", "split", "server_ms",
          "frames_in_tolerance_share", "bodies", "awake", "links", "migrations",
          "foreign_hosted_share", "missed_interactions", "missed_interactions_in_tolerance",
          "speedup", "efficiency", "efficiency_ideal"}) {
      CAPTURE(field);
      CHECK(bucket.contains(field));
    }
    CHECK(bucket["t_end_s"] == 3);
    CHECK(bucket["bodies"].size() == (mode == "single" ? 1u : 4u));
    CHECK(bucket["worst_server_ms"].get<double>() > 0);
    CHECK(bucket["max_frame_ms"] >= bucket["worst_server_ms"]);
    double split = 0;
    for (const char* part : {"physics", "aura", "decide", "wire"})
      split += bucket["split"][part].get<double>();
    CHECK(split == Approx(bucket["worst_server_ms"].get<double>()));

    // 180 at the rate of the options, but for what injectors are behind by. Some are in flight.
    const auto injected = report["bodies_injected"].get<std::uint64_t>();
    CHECK(injected >= 174);
    CHECK(injected <= 186);
    CHECK(bodies_at_end(report) <= injected);
    CHECK(bodies_at_end(report) + (talks ? 5 : 0) >= injected);
    CHECK(report["refused_messages"] == 0);

    CHECK(bucket["efficiency"].is_number() == talks);
    CHECK(bucket["efficiency_ideal"].is_number() == talks);
    CHECK(bucket["speedup"].is_number() == talks);
    CHECK(report["references"].size() == (talks ? 3u : 0u));
    CHECK(bucket["missed_interactions"].is_number() == talks);
    if (talks) {
      CHECK(report["bodies_lost"] == 0);
      CHECK(report["bodies_duplicated"] == 0);
      for (const char* part : {"physics", "aura", "decide", "wire"})
        CHECK(bucket["split"][part].get<double>() > 0);
    }
    const bool wire = talks || mode == "single";
    CHECK(bucket["links"].empty() != wire);
    if (mode == "cut") CHECK(bucket["foreign_hosted_share"] == 0);
  }
}

TEST_CASE("servers that talk are measured against the very runs that stand alone") {
  const json beside = run(small("adaptive"))["references"];
  for (const std::string mode : {"single", "cut", "ideal"}) {
    CAPTURE(mode);
    const json alone = run(small(mode))["buckets"][0];
    for (const char* field : {"bodies", "awake", "migrations", "links", "foreign_hosted_share"}) {
      CAPTURE(field);
      CHECK(beside[mode]["buckets"][0][field] == alone[field]);
    }
  }
}

TEST_CASE("the same seed gives the same run but for its times, another one another run") {
  ExperimentOptions options = small("adaptive");
  options.with_single = false;
  const json once = run(options), again = run(options);
  CHECK(without_times(once) == without_times(again));
  options.workload.seed = 8;
  CHECK(run(options)["state_hash"] != once["state_hash"]);
}

TEST_CASE("repeats change no counts") {
  ExperimentOptions options = small("adaptive");
  options.with_single = false;
  const json once = run(options);
  options.repeats = 2;
  json twice = run(options);
  CHECK(twice["buckets"][0]["speedup"].is_null());
  CHECK(twice["experiment"]["repeats"] == 2);
  twice["experiment"]["repeats"] = 1;
  CHECK(without_times(once) == without_times(twice));
}

TEST_CASE("a layout for so many servers is refused before anything runs") {
  ExperimentOptions options = small("adaptive");
  options.workload.servers = 7;
  const auto report = run_experiment(options, [](const std::string&) {});
  REQUIRE_FALSE(report);
  CHECK(report.error().message == "corners are measured on 1, 3, 4 or 9 servers, not on 7");
}
