// The plan: what runs, under which names, and that `aureole experiment` understands each of them.
#include "server/measure/figures/plan.h"

#include <poll.h>
#include <unistd.h>

#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "server/measure/figures/runner.h"
#include "server/play/child_process.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::vector<PlannedRun> quick_and_full() {
  std::vector<PlannedRun> all = plan_of({});
  PlanOptions quick;
  quick.quick = true;
  for (PlannedRun& run : plan_of(quick)) all.push_back(std::move(run));
  return all;
}

std::set<int> servers_in(const std::vector<PlannedRun>& plan, Study study,
                         const std::string& mode) {
  std::set<int> servers;
  for (const PlannedRun& run : plan)
    if (run.study == study && run.mode == mode) servers.insert(run.servers);
  return servers;
}

/// What a process says on stderr until it ends.
std::string complaint_of(const std::vector<std::string>& arguments) {
  auto child = ChildProcess::start(AUREOLE_BINARY, arguments);
  REQUIRE(child);
  std::string said;
  while (child->descriptor(Output::error) >= 0) {
    pollfd ready{child->descriptor(Output::error), POLLIN, 0};
    poll(&ready, 1, -1);
    child->read(Output::error, [&](const std::string& line) { said += line + "\n"; });
  }
  while (child->is_running()) usleep(500);
  return said;
}

}  // namespace

TEST_CASE("no two runs of a plan have the same name, or the same command line in one study") {
  for (const bool quick : {false, true}) {
    PlanOptions options;
    options.quick = quick;
    std::set<std::string> names, lines;
    for (const PlannedRun& run : plan_of(options)) {
      CAPTURE(run.name());
      CHECK(names.insert(run.name()).second);
      CHECK(lines.insert(std::string(word_of(run.study)) + command_line(run.arguments())).second);
    }
    CHECK(names.size() > 40);
  }
}

TEST_CASE("the plan has the server counts of the paper, ours five times, and all demands' ones") {
  const auto plan = plan_of({});
  for (const std::string mode : {"paper", "adaptive"}) {
    CHECK(servers_in(plan, Study::fig5, mode) == std::set<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
    // One server is the same run for both.
    CHECK(servers_in(plan, Study::fig7, mode) == std::set<int>{3, 4, 9});
  }
  CHECK(servers_in(plan, Study::weak, "adaptive") == std::set<int>{4, 16, 64});
  for (const PlannedRun& run : plan)
    if (run.study == Study::fig5 || run.study == Study::fig7) {
      CHECK(run.seconds == 60);
      CHECK(run.rate_per_s == 160);
      CAPTURE(run.name());
      CHECK(run.repeats == (run.mode == "adaptive" ? 5 : 1));
      // One server has no boundary.
      CHECK(run.references == (run.servers > 1));
      CHECK(run.single == (run.servers > 1 && run.mode == "adaptive"));
      CHECK(run.judged == (run.servers > 1));
      CHECK(run.network == PlannedNetwork{});
      CHECK(run.tolerances == PlannedTolerances{});
    }
}

TEST_CASE("every planned command line is one that aureole experiment understands") {
  // It looks whether it can write its file before it runs, and after it has read everything else.
  for (const PlannedRun& run : quick_and_full()) {
    auto arguments = run.arguments();
    CAPTURE(command_line(arguments));
    arguments.insert(arguments.end(), {"--json", "/nonexistent/report.json"});
    CHECK(complaint_of(arguments) == "aureole: cannot write /nonexistent/report.json\n");
  }
}

TEST_CASE("a command line says everything in which a run differs from the paper's") {
  PlannedRun run;
  run.layout = "corner";
  run.servers = 4;
  run.network = {20, 5, 0.5};
  run.tolerances = {16, 40, true};
  run.judged = run.references = false;
  CHECK(command_line(run.arguments()) ==
        "aureole experiment corner --servers 4 --mode adaptive --seconds 60 --rate 160 --seed 1 "
        "--repeat 1 --latency-ms 20 --jitter-ms 5 --loss-pct 0.5 --speed-tolerance 16 "
        "--latency-tolerance 40 --tolerances follow --no-judge --no-references");
}

TEST_CASE("seconds, rate, repeats, seed and studies can be chosen") {
  PlanOptions options;
  options.only = {Study::fig7, Study::weak};
  options.seconds = 5;
  options.rate_per_s = 40;
  options.repeats = 2;
  options.seed = 9;
  const auto plan = plan_of(options);
  CHECK(plan.size() == 9);
  for (const PlannedRun& run : plan) {
    CHECK((run.study == Study::fig7 || run.study == Study::weak));
    CHECK(run.seconds == 5);
    CHECK(run.rate_per_s == 40);
    CHECK(run.repeats == (run.study == Study::fig7 && run.mode == "paper" ? 1 : 2));
    CHECK(run.seed == 9);
  }
  options.servers = {4, 9, 16};
  const auto some = plan_of(options);
  CHECK(servers_in(some, Study::fig7, "adaptive") == std::set<int>{4, 9});
  CHECK(servers_in(some, Study::fig7, "paper") == std::set<int>{4, 9});
  CHECK(servers_in(some, Study::weak, "adaptive") == std::set<int>{4, 16});
  CHECK(some.size() == 6);
}

TEST_CASE("references run beside every repeat, and `single` beside the first of ours only") {
  PlannedRun run;
  run.servers = 10;
  run.repeats = 5;
  CHECK(command_line(run.arguments()) ==
        "aureole experiment column --servers 10 --mode adaptive --seconds 60 --rate 160 --seed 1 "
        "--repeat 5 --latency-ms 2 --jitter-ms 1 --single-repeats 1");
  run.repeats = 1;
  run.single = false;
  CHECK(command_line(run.arguments()) ==
        "aureole experiment column --servers 10 --mode adaptive --seconds 60 --rate 160 --seed 1 "
        "--repeat 1 --latency-ms 2 --jitter-ms 1 --no-single");
}

TEST_CASE("a run comes back from JSON as it was, and not from JSON that lacks something") {
  for (const PlannedRun& run : quick_and_full()) {
    const auto back = planned_run_from(to_json(run));
    REQUIRE(back);
    CHECK(*back == run);
  }
  const nlohmann::json whole = to_json(PlannedRun{});
  const std::set<std::string> from_later_builds = {"single", "cold_caches_s", "region_m"};
  for (const auto& [name, value] : whole.items()) {
    CAPTURE(name);
    nlohmann::json broken = whole;
    broken.erase(name);
    if (!from_later_builds.count(name)) CHECK_FALSE(planned_run_from(broken));
    broken[name] = nlohmann::json::array();
    CHECK_FALSE(planned_run_from(broken));
  }
  CHECK_FALSE(planned_run_from("fig5"));
}

TEST_CASE("a run comes back only if `aureole experiment` takes what it says, else by its field") {
  const nlohmann::json whole = to_json(PlannedRun{});
  struct Case {
    const char* field;
    nlohmann::json value;
    const char* sentence;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"servers", 65, "`servers` of the run is wrong; expected a whole number from 1 to 64"},
           {"servers", 0, "from 1 to 64"},
           {"servers", 4294967300, "from 1 to 64"},
           {"servers", 2.5, "from 1 to 64"},
           {"layout", "ring", "`layout` of the run is wrong; expected one of column, corner, grid"},
           {"mode", "paper` | <b>", "`mode` of the run is wrong; expected one of single, naive"},
           {"repeats", 4294967297, "from 1 to 100"},
           {"seconds", 1e9, "`seconds` of the run is wrong; expected a number from 0.5 to 3600"},
           {"rate_per_s", -1, "a number from 1 to 10000"},
           {"seed", -1, "a whole number that is not negative"},
           {"seed", 1.5, "a whole number that is not negative"},
           {"loss_pct", 21, "from 0 to 20"},
           {"region_m", 40, "`region_m` of the run is wrong; expected a number from 50 to 800"},
           {"judged", 1, "true or false"}}) {
    nlohmann::json changed = whole;
    changed[c.field] = c.value;
    CAPTURE(changed.dump());
    const auto back = planned_run_from(changed);
    REQUIRE_FALSE(back);
    CHECK(back.error().message.find(c.sentence) != std::string::npos);
    CHECK(back.error().message.find("<b>") == std::string::npos);
  }
  nlohmann::json largest = whole;
  largest["servers"] = 64;
  largest["seed"] = std::numeric_limits<std::uint64_t>::max();
  const auto back = planned_run_from(largest);
  REQUIRE(back);
  CHECK(back->servers == 64);
  CHECK(back->seed == std::numeric_limits<std::uint64_t>::max());
}

TEST_CASE("a run that was made before builds knew of everything comes back as what it was") {
  PlannedRun run;
  for (const std::string mode : {"adaptive", "paper"}) {
    run.mode = mode;
    auto old = to_json(run);
    old.erase("single");
    old.erase("cold_caches_s");
    const auto back = planned_run_from(old);
    REQUIRE(back);
    CHECK(back->single == (mode == "adaptive"));
    CHECK(back->cold_caches_s == 0);
  }
}

TEST_CASE("regions are as large as the volumes beside boundaries, but in the study of their size") {
  std::set<std::string> sizes;
  for (const PlannedRun& run : plan_of({})) {
    CAPTURE(run.name());
    const bool is_usual = run.region_m == 150;
    CHECK((is_usual || run.study == Study::regions));
    const std::string line = command_line(run.arguments());
    CHECK((line.find("--region ") == std::string::npos) == is_usual);
    if (run.study != Study::regions) continue;
    CHECK(run.references);
    CHECK(run.judged);
    sizes.insert(run.name());
  }
  CHECK(sizes ==
        std::set<std::string>{
            "regions-corner-04-adaptive-region-100", "regions-corner-04-adaptive-region-150",
            "regions-corner-04-adaptive-region-200", "regions-corner-04-adaptive-region-300",
            "regions-column-02-adaptive-region-150", "regions-column-02-adaptive-region-300"});
}

TEST_CASE("servers are compared with cold caches where their number grows, and nowhere else") {
  for (const PlannedRun& run : quick_and_full()) {
    CAPTURE(run.name());
    CHECK(run.cold_caches_s == (run.study == Study::weak ? 10 : 0));
    const std::string line = command_line(run.arguments());
    CHECK((line.find("--cold-caches 10") != std::string::npos) == (run.study == Study::weak));
  }
}
