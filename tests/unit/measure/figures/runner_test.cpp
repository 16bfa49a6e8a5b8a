// Making runs, leaving those that are made, going on after failures, and stopping; a shell script
// stands in for aureole.
#include "server/measure/figures/runner.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include "server/measure/figures/run_files.h"
#include "server/ops/temporary_folder.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A folder with a script that is called like aureole: $json is where it shall write.
struct Stage {
  std::unique_ptr<TemporaryFolder> folder;
  RunnerOptions options;
  std::vector<std::string> said, shown;
  std::vector<PlannedRun> plan;

  explicit Stage(const std::string& body = whole_report) {
    auto made = TemporaryFolder::make(std::filesystem::temp_directory_path());
    REQUIRE(made);
    folder = std::move(*made);
    options.out = folder->path() / "out";
    options.executable = folder->path() / "fake";
    options.build = "build 1";
    write_script(body);
    PlanOptions columns;
    columns.only = {Study::fig7};
    columns.seconds = 5;
    plan = plan_of(columns);
    plan.resize(3);
  }

  static constexpr const char* whole_report = R"(echo '{"buckets": [{"t_end_s": 5}]}' > "$json")";

  void write_script(const std::string& body) const {
    // Every start is noted.
    std::ofstream(options.executable)
        << "#!/bin/sh\nall=\"$*\"\nwhile [ \"$1\" != --json ]; do shift; done\njson=$2\n"
        << "echo \"$all\" >> \"" << (folder->path() / "starts").string() << "\"\n"
        << body << "\n";
    std::filesystem::permissions(options.executable, std::filesystem::perms::owner_all);
  }

  RunnerOutcome go() {
    const RunnerReport report{[this](const std::string& line) { said.push_back(line); },
                              [this](const std::string& what) { shown.push_back(what); }};
    auto outcome = run_plan(plan, options, report);
    REQUIRE(outcome);
    return *outcome;
  }

  std::size_t starts() const {
    const std::string all = text_of(folder->path() / "starts");
    return static_cast<std::size_t>(std::count(all.begin(), all.end(), '\n'));
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(options.out / "runs"))
      names.insert(entry.path().filename().string());
    return names;
  }
  std::set<std::string> planned_files() const {
    std::set<std::string> names;
    for (const PlannedRun& run : plan) names.insert(run.name() + ".json");
    return names;
  }
  std::string all_said() const {
    std::string all;
    for (const std::string& line : said) all += line + "\n";
    return all;
  }
};

}  // namespace

TEST_CASE("every run is made once, and its file says how") {
  Stage stage;
  const RunnerOutcome outcome = stage.go();
  CHECK(outcome.made == 3);
  CHECK(outcome.already == 0);
  CHECK(outcome.failed == 0);
  CHECK_FALSE(outcome.stopped);
  CHECK(stage.files() == stage.planned_files());
  for (const PlannedRun& planned : stage.plan) {
    const auto run = read_run(run_file(stage.options.out, planned));
    REQUIRE(run);
    CHECK(run->plan == planned);
    CHECK(run->arguments == planned.arguments());
    CHECK(run->build == "build 1");
    CHECK(run->report["buckets"].size() == 1);
  }
}

TEST_CASE("what was made with the same command line by the same build is not made again") {
  Stage stage;
  stage.go();
  const RunnerOutcome again = stage.go();
  CHECK(again.made == 0);
  CHECK(again.already == 3);
  CHECK(stage.starts() == 3);
  CHECK(stage.all_said().find("3 of 3 runs are already there") != std::string::npos);

  SECTION("what is missing is made") {
    std::filesystem::remove(run_file(stage.options.out, stage.plan[1]));
    CHECK(stage.go().made == 1);
  }
  SECTION("what another build has made is made again, unless any build will do") {
    stage.options.build = "build 2";
    stage.options.any_build = true;
    CHECK(stage.go().made == 0);
    stage.options.any_build = false;
    CHECK(stage.go().made == 3);
    CHECK(stage.go().already == 3);
  }
  SECTION("what was made with another command line is made again") {
    stage.plan[2].repeats = 7;
    CHECK(stage.go().made == 1);
  }
  SECTION("a file that was cut off is made again") {
    const auto file = run_file(stage.options.out, stage.plan[0]);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    CHECK(stage.go().made == 1);
  }
}

TEST_CASE("a run that fails is told with its command and last lines, and the others go on") {
  Stage stage(R"(case "$all" in *"--mode paper"*) echo first; echo "no luck" >&2; exit 3;; esac
)" + std::string(Stage::whole_report));
  const RunnerOutcome outcome = stage.go();
  CHECK(outcome.failed == 1);
  CHECK(outcome.made == 2);
  const std::string said = stage.all_said();
  CHECK(said.find(stage.plan[1].name() + " failed: it ended with exit code 3") !=
        std::string::npos);
  CHECK(said.find(command_line(stage.plan[1].arguments())) != std::string::npos);
  CHECK(said.find("  | no luck") != std::string::npos);
  CHECK(stage.files().count(stage.plan[1].name() + ".json") == 0);
  // It is tried again, the others are not.
  stage.write_script(Stage::whole_report);
  CHECK(stage.go().made == 1);
}

TEST_CASE("a process that ends well without a whole report has failed, and leaves nothing") {
  for (const std::string body :
       {"true", R"(printf '{"buckets": [{"t_end' > "$json")", R"(echo '{"buckets": []}' > "$json")",
        R"(echo '[1]' > "$json")", R"(echo '{"buckets": [{"t_end_s": "5"}]}' > "$json")"}) {
    CAPTURE(body);
    Stage stage(body);
    CHECK(stage.go().failed == 3);
    CHECK(stage.files().empty());
  }
}

TEST_CASE("being asked to stop ends what runs and leaves what is done") {
  // The second one writes half of its report and waits for ever.
  Stage stage(R"(case "$all" in *"--mode paper"*)
  printf '{"buckets"' > "$json"; echo $$ > "${0%/*}/pid"; exec sleep 1000;; esac
)" + std::string(Stage::whole_report));
  int stop[2];
  REQUIRE(pipe(stop) == 0);
  stage.options.stop_fd = stop[0];
  const auto pid_file = stage.folder->path() / "pid";
  std::thread asker([&] {
    while (text_of(pid_file).empty()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    REQUIRE(write(stop[1], "x", 1) == 1);
  });
  const RunnerOutcome outcome = stage.go();
  asker.join();
  CHECK(outcome.stopped);
  CHECK(outcome.made == 1);
  CHECK(outcome.failed == 0);
  CHECK(stage.files() == std::set<std::string>{stage.plan[0].name() + ".json"});
  CHECK(kill(std::stoi(text_of(pid_file)), 0) != 0);
  close(stop[0]);
  close(stop[1]);

  // The next start goes on there.
  stage.options.stop_fd = -1;
  stage.write_script(Stage::whole_report);
  const RunnerOutcome next = stage.go();
  CHECK(next.already == 1);
  CHECK(next.made == 2);
}

TEST_CASE("several jobs run side by side") {
  // Each waits until the other one has come.
  Stage stage(R"(touch "${0%/*}/here-$$"
while [ $(ls "${0%/*}" | grep -c here-) -lt 2 ]; do sleep 0.01; done
)" + std::string(Stage::whole_report));
  stage.plan.resize(2);
  stage.options.jobs = 2;
  CHECK(stage.go().made == 2);
}

TEST_CASE("progress tells what runs, how many are done, and what is left") {
  Stage stage("sleep 0.3\necho 'repeat 1 of 1' >&2\nsleep 0.3\n" +
              std::string(Stage::whole_report));
  stage.plan.resize(2);
  stage.go();
  std::string all;
  for (const std::string& what : stage.shown) all += what + "\n";
  CHECK(all.find("0 of 2 runs done; " + stage.plan[0].name()) != std::string::npos);
  CHECK(all.find("repeat 1 of 1") != std::string::npos);
  CHECK(all.find("1 of 2 runs done; ") != std::string::npos);
  CHECK(all.find("s left") != std::string::npos);
}

TEST_CASE("a time is told as roughly as a person would") {
  CHECK(in_words(0.4) == "0 s");
  CHECK(in_words(25) == "25 s");
  CHECK(in_words(240) == "4 min");
  CHECK(in_words(7500) == "2 h 05 min");
}

TEST_CASE("a build's version changes with the executable") {
  const Stage stage;
  const auto before = build_version(stage.options.executable);
  REQUIRE(before);
  CHECK(*build_version(stage.options.executable) == *before);
  stage.write_script("exit 0");
  CHECK(*build_version(stage.options.executable) != *before);
  CHECK_FALSE(build_version(stage.folder->path() / "nothing"));
}
