// Small runs of every mode: the report is whole, bodies agree, and the same seed is the same run.
#include "server/measure/experiment.h"

#include <nlohmann/json.hpp>
#include <set>

#include "server/measure/measured/bare_worlds.h"
#include "server/measure/measured/cold_caches.h"
#include "server/measure/measured/region_servers.h"
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
  static const std::set<std::string> times = {
      "max_frame_ms", "worst_server_ms",  "p99_frame_ms",
      "split",        "server_ms",        "frames_in_tolerance_share",
      "speedup",      "efficiency",       "efficiency_ideal",
      "last_10_s",    "median_server_ms", "ticks_in_tolerance_share",
      "server_split", "ticks_outside"};
  json rest = value;
  if (value.is_object())
    for (const std::string& name : times) rest.erase(name);
  for (json& part : rest)
    if (part.is_structured()) part = without_times(part);
  return rest;
}

const char* const every_mode[] = {"single", "naive", "paper", "adaptive", "ideal", "cut"};

}  // namespace

TEST_CASE("cold caches change times and nothing else") {
  for (const std::string mode : {"adaptive", "cut"}) {
    CAPTURE(mode);
    ExperimentOptions options = small(mode);
    options.judged = false;
    options.workload.seconds = 1;
    const json warm = run(options);
    options.cold_caches_s = 0.5;
    const json cold = run(options);
    CHECK(warm["experiment"]["cold_caches_s"] == 0);
    CHECK(cold["experiment"]["cold_caches_s"] == 0.5);
    CHECK(warm["state_hash"] == cold["state_hash"]);
  }
}

TEST_CASE("caches are chilled before each frame of each server") {
  const auto world = workload_world(small("adaptive").workload);
  REQUIRE(world);
  int frames = 0;
  const auto count = [&] { ++frames; };
  RegionServers::Options options;
  options.before_frame = count;
  RegionServers servers(*world, options);
  for (int i = 0; i < 5; ++i) servers.tick();
  CHECK(frames == 5 * 4);
  BareWorlds worlds(*world, BareWorlds::Crossing::stays, cpu_clocks(), count);
  for (int i = 0; i < 5; ++i) worlds.tick();
  CHECK(frames == 2 * 5 * 4);
}

TEST_CASE("a walk through more than caches hold touches at least twice that, and can be repeated") {
  ColdCaches caches;
  CHECK(caches.bytes() >= 1u << 20);
  CHECK(caches.bytes() <= 1u << 30);
  caches.chill();
  caches.chill();
}

TEST_CASE("every mode's report has every field, and all of its bodies") {
  for (const std::string mode : every_mode) {
    CAPTURE(mode);
    const json report = run(small(mode));
    const bool talks = mode == "naive" || mode == "paper" || mode == "adaptive";
    REQUIRE(report["buckets"].size() == 1);
    const json& bucket = report["buckets"][0];
    for (const char* field : {"t_end_s",
                              "max_frame_ms",
                              "worst_server_ms",
                              "p99_frame_ms",
                              "split",
                              "server_ms",
                              "server_split",
                              "frames_in_tolerance_share",
                              "bodies",
                              "awake",
                              "links",
                              "migrations",
                              "foreign_hosted_share",
                              "missed_interactions",
                              "missed_interactions_in_tolerance",
                              "median_server_ms",
                              "ticks_in_tolerance_share",
                              "ticks_outside",
                              "latency_tolerance_ms",
                              "handoff_jump_mm",
                              "wire",
                              "speedup",
                              "efficiency",
                              "efficiency_ideal"}) {
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
    REQUIRE(bucket["server_split"].size() == bucket["server_ms"].size());
    for (std::size_t k = 0; k < bucket["server_ms"].size(); ++k) {
      double parts = 0;
      for (const json& part : bucket["server_split"][k]) parts += part.get<double>();
      CHECK(parts == Approx(bucket["server_ms"][k].get<double>()));
    }

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
    for (const json& part : {bucket, report["total"]}) {
      CHECK(part["wire"].is_object() == talks);
      CHECK(part["handoff_jump_mm"].is_object() == talks);
      CHECK(part["ticks_in_tolerance_share"].is_number() == (talks || mode == "single"));
    }
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
  CHECK(twice["experiment"]["reference_repeats"] == 2);
  CHECK(twice["experiment"]["single_repeats"] == 0);
  twice["experiment"]["repeats"] = twice["experiment"]["reference_repeats"] = 1;
  CHECK(without_times(once) == without_times(twice));
}

TEST_CASE("references may run beside some repeats only, and are compared with these") {
  ExperimentOptions options = small("adaptive");
  options.with_single = false;
  options.repeats = 3;
  options.reference_repeats = 1;
  const json report = run(options);
  CHECK(report["experiment"]["repeats"] == 3);
  CHECK(report["experiment"]["reference_repeats"] == 1);
  const json& last = report["last_10_s"];
  // What ran once beside `cut` is a third of all that was measured of ours.
  CHECK(last["reference_ms"]["adaptive"] != last["worst_server_ms"]);
  CHECK(last["efficiency"].get<double>() == Approx(last["reference_ms"]["cut"].get<double>() /
                                                   last["reference_ms"]["adaptive"].get<double>()));
  options.reference_repeats = options.repeats = 1;
  json once = run(options), thrice = report;
  once["experiment"]["repeats"] = 3;
  CHECK(without_times(once) == without_times(thrice));
}

TEST_CASE("`single` may run beside fewer repeats than the other references") {
  ExperimentOptions options = small("adaptive");
  options.repeats = 2;
  options.single_repeats = 1;
  const json report = run(options);
  CHECK(report["experiment"]["reference_repeats"] == 2);
  CHECK(report["experiment"]["single_repeats"] == 1);
  const json& last = report["last_10_s"];
  const double ours_ms = last["worst_server_ms"], single_ms = last["reference_ms"]["single"];
  // All of ours ran beside `cut`, half of it beside `single`.
  CHECK(last["reference_ms"]["adaptive"] == ours_ms);
  CHECK(last["efficiency"].get<double>() ==
        Approx(last["reference_ms"]["cut"].get<double>() / ours_ms));
  CHECK(last["speedup"].get<double>() > 0);
  CHECK(last["speedup"].get<double>() != single_ms / ours_ms);
}

TEST_CASE("a layout for so many servers is refused before anything runs") {
  ExperimentOptions options = small("adaptive");
  options.workload.servers = 7;
  const auto report = run_experiment(options, [](const std::string&) {});
  REQUIRE_FALSE(report);
  CHECK(report.error().message == "corners are measured on 1, 3, 4 or 9 servers, not on 7");
}

TEST_CASE("a bucket's bytes and jumps add up to those of the run") {
  ExperimentOptions options = small("adaptive");
  options.workload.seconds = 7;
  options.with_references = false;
  const json report = run(options);
  REQUIRE(report["buckets"].size() == 2);
  CHECK(report["references"].empty());
  const json& total = report["total"];
  for (const char* count : {"aura_bytes", "moving_auras", "replica_bytes", "moving_replicas",
                            "key_bytes", "resting_bytes", "sign_of_life_bytes"}) {
    CAPTURE(count);
    std::uint64_t sum = 0;
    for (const json& bucket : report["buckets"]) sum += bucket["wire"][count].get<std::uint64_t>();
    CHECK(sum == total["wire"][count].get<std::uint64_t>());
    CHECK(sum > 0);
  }
  std::size_t samples = 0;
  for (const json& bucket : report["buckets"])
    samples += bucket["handoff_jump_mm"]["samples"].get<std::size_t>();
  CHECK(samples > 0);
  CHECK(samples == total["handoff_jump_mm"]["samples"].get<std::size_t>());
  // A pose is 20 bytes; only an envelope comes on top.
  const double bytes = total["wire"]["replica_bytes_per_moving_tick"].get<double>();
  CHECK(bytes > 15);
  CHECK(bytes < 40);
}

TEST_CASE("without the oracles and the references the run is the same one") {
  ExperimentOptions options = small("adaptive");
  const json whole = run(options);
  options.with_references = options.judged = false;
  const json bare = run(options);
  CHECK(bare["state_hash"] == whole["state_hash"]);
  CHECK(bare["references"].empty());
  CHECK(bare["bodies_lost"].is_null());
  CHECK(bare["buckets"][0]["efficiency"].is_null());
  CHECK(bare["total"]["wire"].is_null());
}

TEST_CASE("one server is left out of what it would take too long for") {
  using Runs = std::vector<std::string>;
  ExperimentOptions options;
  options.workload.layout = "grid";
  options.workload.servers = 4;
  CHECK(runs_of(options) == Runs{"adaptive", "cut", "ideal", "single"});
  options.workload.servers = 16;  // 640 bodies a second for a minute.
  CHECK(runs_of(options) == Runs{"adaptive", "cut", "ideal"});
  options.workload.seconds = 10;
  CHECK(runs_of(options) == Runs{"adaptive", "cut", "ideal", "single"});
  options.with_single = false;
  CHECK(runs_of(options) == Runs{"adaptive", "cut", "ideal"});
  options.with_references = false;
  CHECK(runs_of(options) == Runs{"adaptive"});
  options.mode = "cut";
  options.with_references = true;
  CHECK(runs_of(options) == Runs{"cut"});
}

TEST_CASE("a tolerance that follows covers a long latency, a fixed one does not") {
  ExperimentOptions options = small("paper");
  options.with_references = false;
  options.workload.seconds = 6;
  options.latency_ms = 40;
  options.jitter_ms = 5;
  const json fixed = run(options);
  options.follow_latency = true;
  const json follows = run(options);
  CHECK(fixed["buckets"][1]["latency_tolerance_ms"] == 2);
  CHECK(follows["buckets"][1]["latency_tolerance_ms"] == 50);
  CHECK(fixed["buckets"][1]["ticks_outside"]["latency"] == 1);
  CHECK(follows["buckets"][1]["ticks_outside"]["latency"] == 0);
  CHECK(follows["buckets"][0]["ticks_outside"]["latency"].get<double>() < 0.2);
  // Larger auras, so that other bodies are brought together.
  CHECK(fixed["state_hash"] != follows["state_hash"]);
  CHECK(follows["total"]["missed_interactions_in_tolerance"] == 0);
  CHECK(follows["bodies_lost"] == 0);
}

TEST_CASE("loss delays a run and loses nothing") {
  ExperimentOptions options = small("adaptive");
  options.with_references = false;
  options.workload.rate_per_s = 800;  // So that enough is handed over.
  const json calm = run(options);
  options.loss_pct = 5;
  const json lossy = run(options);
  CHECK(lossy["state_hash"] != calm["state_hash"]);
  CHECK(lossy["bodies_lost"] == 0);
  CHECK(lossy["bodies_duplicated"] == 0);
  CHECK(lossy["refused_messages"] == 0);
  CHECK(lossy["total"]["ticks_outside"]["link"] > 0.01);
  CHECK(calm["total"]["ticks_outside"]["link"] == 0);
}

TEST_CASE("tolerances that are said are the world's") {
  ExperimentOptions options = small("adaptive");
  options.with_references = options.judged = false;
  options.workload.tolerances = {20, 5, 1e-9};
  const json report = run(options);
  CHECK(report["experiment"]["tolerances"]["speed_mps"] == 20);
  CHECK(report["experiment"]["tolerances"]["latency_ms"] == 5);
  CHECK(report["buckets"][0]["latency_tolerance_ms"] == 5);
  CHECK(report["buckets"][0]["frames_in_tolerance_share"] == 0);
  CHECK(report["total"]["ticks_in_tolerance_share"] == 0);
}
