// `aureole simulate` as an executable: its exit codes, its report, and that the line that it prints
// on a failure replays it.
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/processes/running.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace aureole;
using aureole::test::Running;
using aureole::testing::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

constexpr const char* small = "--seconds 3 --bodies 40 ";

Running simulate(const std::string& options) {
  return Running(AUREOLE_BINARY, words_of("simulate " + options));
}

nlohmann::json read(const std::string& path) {
  std::ifstream file(path);
  auto json = nlohmann::json::parse(file, nullptr, false);
  REQUIRE(json.is_object());
  return json;
}

/// The lines that tell of broken rules: "  missed at tick 87: …".
std::vector<std::string> broken_rules(const Running& run) {
  std::vector<std::string> lines;
  for (const std::string& line : run.out)
    if (line.starts_with("  ") && line.find(" at tick ") != std::string::npos)
      lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("seeds that hold every rule end with exit code 0 and a report with all totals by name") {
  const TemporaryFolder folder;
  const std::string report = folder.file("report.json");
  Running run = simulate(small + ("--seeds 2 --latency-ms 2 --json " + report));
  const std::string end = run.wait_for_end(120);
  INFO(run.all());
  REQUIRE(end == "exit code 0");
  const nlohmann::json json = read(report);
  for (const char* name :
       {"seeds", "ticks", "bodies_spawned", "bodies_lost", "bodies_duplicated",
        "missed_interactions", "missed_interactions_in_tolerance", "tolerance_events", "migrations",
        "migrations_per_body_max_per_s", "unsettled", "hash_mismatches", "foreign_hosted_share_max",
        "largest_cluster", "handoff_jump_mm_p99", "handoff_jump_mm_max", "cpu_s"}) {
    INFO(name);
    CHECK(json.contains(name));
    CHECK((json.contains(name) && json[name].is_number()));
  }
  CHECK(json["seeds"] == 2);
  CHECK(json["bodies_spawned"] >= 60);
  CHECK(json["migrations"] > 0);
  CHECK(json["compared_with_one_server"] >= 6);
  CHECK(json["per_seed"].size() == 2);
  CHECK(json["failures"].empty());
}

TEST_CASE(
    "a seed that breaks a rule ends with exit code 1, and its replay fails at the same tick") {
  const TemporaryFolder folder;
  const std::string report = folder.file("report.json");
  Running run = simulate(
      std::string(small) +
      "--layout column4 --mode naive --seed 2 --seeds 1 --no-compare-single --json " + report);
  const std::string end = run.wait_for_end(120);
  INFO(run.all());
  REQUIRE(end == "exit code 1");
  const std::vector<std::string> told = broken_rules(run);
  REQUIRE(!told.empty());
  CHECK(told.front().find("missed at tick ") != std::string::npos);
  CHECK(told.front().find("injector") != std::string::npos);
  CHECK(told.front().find(" on r") != std::string::npos);
  const nlohmann::json failures = read(report)["failures"];
  REQUIRE(failures.size() == 1);

  const auto line = run.line_with("replay: ");
  REQUIRE(line);
  const std::string command = line->substr(line->find("aureole "));
  CHECK(failures[0]["replay"] == command);
  std::vector<std::string> words = words_of(command);
  words.erase(words.begin());  // The executable's name.
  Running again(AUREOLE_BINARY, words);
  const std::string second_end = again.wait_for_end(120);
  INFO(again.all());
  CHECK(second_end == "exit code 1");
  const std::vector<std::string> told_again = broken_rules(again);
  REQUIRE(told_again.size() >= told.size());
  for (std::size_t n = 0; n < told.size(); ++n) CHECK(told_again[n] == told[n]);
}

TEST_CASE("messages of two ticks are judged like any others where the tolerance allows for them") {
  const TemporaryFolder folder;
  for (const bool allowed : {false, true}) {
    const std::string report = folder.file("report.json");
    Running run = simulate(small + ("--seeds 1 --latency-ms 13 --no-compare-single --json " +
                                    report + (allowed ? " --latency-tolerance 15" : "")));
    const std::string end = run.wait_for_end(120);
    INFO(run.all());
    REQUIRE(end == "exit code 0");
    const nlohmann::json json = read(report);
    CHECK((json["tolerance_events"] == 0) == allowed);
    CHECK(json["migrations"] > 0);
  }
}

TEST_CASE("a world file can be simulated, also one into which bodies pour until the end") {
  const TemporaryFolder folder;
  for (const double duration_s : {3.0, 300.0}) {
    const std::string path = folder.file("two halves.json");
    std::ofstream(path) << nlohmann::json::parse(R"({
      "name": "two halves",
      "bounds": {"min": [-60, -20, -60], "max": [60, 80, 60]},
      "regions": [{"name": "r0", "area": {"max_x": 0}}, {"name": "r1", "area": {"min_x": 0}}],
      "definitions": {"sphere": {"shape": {"type": "sphere", "radius": 0.3}, "mass_kg": 10}},
      "statics": [{"name": "ground", "shape": {"type": "plane"}, "position": [0, 0, 0]}],
      "bodies": [],
      "spawn_points": [{"position": [10, 0.95, 10]}],
      "injectors": [{"name": "rain", "rate_per_s": 4, "seed": 3, "duration_s": )" +
                                                 std::to_string(duration_s) + R"(,
        "volume": {"min": [-4, 2, -4], "max": [4, 5, 4]},
        "velocity": {"min": [-3, -3, -3], "max": [3, 0, 3]}, "mix": [{"body": "sphere"}]}]})");
    const std::string report = folder.file("report.json");
    Running run(AUREOLE_BINARY, {"simulate", "--layout", path, "--seeds", "1", "--seed", "1",
                                 "--seconds", "3", "--no-compare-single", "--json", report});
    const std::string end = run.wait_for_end(120);
    INFO(run.all());
    CHECK(end == "exit code 0");
    CHECK(read(report)["bodies_spawned"] >= 12);
    CHECK(read(report)["migrations"] > 0);
  }
}

TEST_CASE("bad options and files of simulate get a sentence and the usage exit code") {
  const TemporaryFolder folder;
  const std::string broken = folder.file("broken.json");
  std::ofstream(broken) << "{\"name\": \"half a wor";
  struct Case {
    std::string options, sentence;
  };
  for (const Case& c : {Case{"--mode sideways", "naive"}, Case{"--faults some", "crashes"},
                        Case{"--seeds 0", "--seeds"}, Case{"--seeds many", "--seeds"},
                        Case{"--seconds 0", "--seconds"}, Case{"--bodies -1", "--bodies"},
                        Case{"--layout corner5", "corner5"},
                        Case{"--layout " + folder.file("none.json"), "none.json"},
                        Case{"--layout " + broken, "broken.json"},
                        Case{"--latency-ms 1 --jitter-ms 2", "--jitter-ms must not be more"},
                        Case{"--no-such-option", "--no-such-option"}}) {
    Running run = simulate(c.options);
    const std::string end = run.wait_for_end(60);
    INFO(c.options << "\n" << run.all());
    CHECK(end == "exit code 2");
    CHECK(run.line_with(c.sentence));
    CHECK(run.out.empty());
  }
}
