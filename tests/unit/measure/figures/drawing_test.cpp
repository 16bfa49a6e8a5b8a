// Runs to pictures: which are drawn, from what, and that gnuplot really draws them.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/tables.h"
#include "server/ops/temporary_folder.h"
#include "tests/support/catch.h"
#include "tests/unit/measure/figures/small_runs.h"

using namespace aureole;

namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::unique_ptr<TemporaryFolder> folder() {
  auto made = TemporaryFolder::make(std::filesystem::temp_directory_path());
  REQUIRE(made);
  return std::move(*made);
}

/// Runs of the studies that vary network, tolerances and the size of regions.
std::vector<FinishedRun> varied_runs() {
  std::vector<FinishedRun> runs;
  PlanOptions options;
  options.quick = true;
  options.only = {Study::latency, Study::tolerances, Study::regions};
  for (const PlannedRun& planned : plan_of(options)) {
    FinishedRun run = small_run(planned.study, planned.mode, planned.servers);
    run.plan = planned;
    runs.push_back(std::move(run));
  }
  return runs;
}

std::vector<FinishedRun> all_runs() {
  auto runs = small_runs();
  for (FinishedRun& run : varied_runs()) runs.push_back(std::move(run));
  return runs;
}

const Figure& named(const std::vector<Figure>& figures, const std::string& name) {
  const auto found = std::find_if(figures.begin(), figures.end(),
                                  [&](const Figure& figure) { return figure.name == name; });
  REQUIRE(found != figures.end());
  return *found;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("whole runs give every figure, and nothing to say about them") {
  std::vector<std::string> notes;
  std::set<std::string> names;
  for (const Figure& figure : figures_of(all_runs(), notes)) names.insert(figure.name);
  CHECK(names == std::set<std::string>{"fig5", "fig7", "efficiency", "split-columns",
                                       "split-corners", "hosted", "latency", "tolerances", "weak",
                                       "regions"});
  CHECK(notes.empty());
}

TEST_CASE("gnuplot draws every figure without a complaint, twice the same") {
  REQUIRE(find_gnuplot());
  std::vector<std::string> notes;
  const auto out = folder();
  for (const Figure& figure : figures_of(all_runs(), notes)) {
    CAPTURE(figure.name);
    const auto drawn = draw(figure, out->path());
    CAPTURE(drawn ? "" : drawn.error().message);
    REQUIRE(drawn);
    const std::string svg = text_of(out->path() / (figure.name + ".svg"));
    CHECK(svg.find("<svg") != std::string::npos);
    CHECK(svg.find("</svg>") != std::string::npos);
    CHECK(svg.find("<title>" + figure.name + "</title>") != std::string::npos);
    // Opaque, so that dark viewers show it as it was meant.
    CHECK(svg.find("fill=\"#ffffff\"") != std::string::npos);
    CHECK(svg.find(figure_font) == std::string::npos);
    CHECK(svg.find("20 s at 160 bodies/s") + svg.find("15 s at 160 bodies/s") !=
          2 * std::string::npos);
    CHECK(text_of(out->path() / "scripts" / (figure.name + ".gp")) == figure.script);
    REQUIRE(draw(figure, out->path()));
    CHECK(text_of(out->path() / (figure.name + ".svg")) == svg);
  }
  // Nothing half done is left.
  for (const auto& entry : std::filesystem::directory_iterator(out->path()))
    CHECK((entry.is_directory() || entry.path().extension() == ".svg"));
}

TEST_CASE("what gnuplot complains of is the error, and no picture is left") {
  REQUIRE(find_gnuplot());
  const auto out = folder();
  const auto drawn = draw({"broken", "", "set terminal svg\nplot nonsense(\n"}, out->path());
  REQUIRE_FALSE(drawn);
  CHECK(drawn.error().message.find("broken.gp") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(out->path() / "broken.svg"));
  CHECK_FALSE(draw({"empty", "", "set terminal svg\n"}, out->path()));
}

TEST_CASE("Fig. 5 has a curve for each server count in each of its three panels") {
  std::vector<std::string> notes;
  const auto figures = figures_of(small_runs(), notes);
  const std::string& script = named(figures, "fig5").script;
  CHECK(count(script, "with lines") == 3 * 4);
  // At 20 s: one server's longest frame, and ten servers' in `ideal`.
  CHECK(script.find("\n20 40\n") != std::string::npos);
  CHECK(script.find("\n20 3.4\n") != std::string::npos);
}

TEST_CASE("a point without its number is left out with a sentence, the others are drawn") {
  auto runs = varied_runs();
  std::vector<std::string> notes;
  const auto before = figures_of(runs, notes);
  REQUIRE(notes.empty());
  runs.front().report["total"].erase("handoff_jump_mm");
  const auto after = figures_of(runs, notes);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("jump at handoff") != std::string::npos);
  CHECK(notes[0].find("left out") != std::string::npos);
  CHECK(named(after, "latency").script.size() < named(before, "latency").script.size());

  // Nobody tells it: no panel for it.
  for (FinishedRun& run : runs) run.report["total"].erase("handoff_jump_mm");
  const auto without = figures_of(runs, notes);
  CHECK(named(without, "latency").script.find("jump at handoff") == std::string::npos);
  CHECK(named(without, "latency").script.find("missed interactions") != std::string::npos);

  auto columns = small_runs();
  notes.clear();
  run_among(columns, Study::fig5, "paper", 4).report["last_10_s"].erase("efficiency");
  figures_of(columns, notes);
  CHECK(notes == std::vector<std::string>{
                     "efficiency: fig5-column-04-paper has no efficiency, its point is left out"});
}

TEST_CASE("a figure takes each mode with as many repeats as most of its runs have") {
  std::vector<std::string> notes;
  const auto runs = small_runs();
  const StudyRuns chosen = runs_of(Study::fig5, runs, notes);
  CHECK(notes.empty());
  CHECK(chosen.runs.size() == 8);
  CHECK(chosen.setting ==
        "20 s at 160 bodies/s, adaptive: mean of 5 repeats, paper: run once, seed 1");
  CHECK(runs_of(Study::weak, runs, notes).setting ==
        "20 s at 160 bodies/s for every 4 servers, mean of 5 repeats, seed 1");
}

TEST_CASE("one server is the same run for columns and corners, and made for either") {
  for (const Study missing : {Study::fig5, Study::fig7}) {
    auto runs = small_runs();
    std::erase_if(runs, [&](const FinishedRun& run) {
      return run.plan.study == missing && run.plan.servers == 1;
    });
    std::vector<std::string> notes;
    const StudyRuns chosen = runs_of(missing, runs, notes);
    CHECK(notes.empty());
    for (const char* mode : {"adaptive", "paper"}) {
      const FinishedRun* one = chosen.find(mode, 1);
      REQUIRE(one != nullptr);
      CHECK(one->plan.study != missing);
    }
    const auto bars = bars_of(runs);
    CHECK(std::none_of(bars.begin(), bars.end(), [](const BarResult& bar) {
      return bar.bar.find(" 1 → ") != std::string::npos && bar.verdict == Verdict::unknown;
    }));
  }
  std::vector<std::string> notes;
  const auto runs = small_runs();
  const StudyRuns corners = runs_of(Study::fig7, runs, notes);
  CHECK(corners.runs.size() == 6);
  for (const FinishedRun* run : corners.runs) CHECK(run->plan.study == Study::fig7);
}

TEST_CASE("a figure mixes no runs of different length, rate, repeats or seed") {
  for (const int what : {0, 1, 2, 3}) {
    auto runs = small_runs();
    PlannedRun& odd = run_among(runs, Study::fig5, "adaptive", 10).plan;
    if (what == 0) odd.seconds = 60;
    if (what == 1) odd.rate_per_s = 40;
    if (what == 2) odd.repeats = 1;
    if (what == 3) odd.seed = 2;
    std::vector<std::string> notes;
    const auto figures = figures_of(runs, notes);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find("fig5-column-10-adaptive is left out") == 0);
    // Its curves in `adaptive` and in `ideal` are gone.
    CHECK(count(named(figures, "fig5").script, "with lines") == 3 * 4 - 2);
  }
}

TEST_CASE("runs come back from their files as they were written, broken ones with a sentence") {
  const auto out = folder();
  std::filesystem::create_directories(out->path() / "runs");
  for (const FinishedRun& run : small_runs())
    REQUIRE(write_run(run_file(out->path(), run.plan), run));
  std::ofstream(out->path() / "runs" / "half.json") << "{\"buckets\": [";
  std::ofstream(out->path() / "runs" / "by-hand.json") << R"({"buckets": [{"t_end_s": 5}]})";
  std::vector<std::string> notes;
  const auto runs = read_runs(out->path(), {}, notes);
  CHECK(runs.size() == 17);
  REQUIRE(notes.size() == 2);
  CHECK(notes[0].find("by-hand.json does not say how it was made") != std::string::npos);
  CHECK(notes[1].find("half.json is not JSON") != std::string::npos);
  CHECK(read_runs(out->path(), {Study::weak}, notes).size() == 3);
  for (const FinishedRun& run : runs)
    CHECK(run.report["buckets"] ==
          small_run(run.plan.study, run.plan.mode, run.plan.servers).report["buckets"]);
}

TEST_CASE(
    "a run with a number that cannot be one is left out with its file, key and what is taken") {
  const auto out = folder();
  std::filesystem::create_directories(out->path() / "runs");
  FinishedRun run = small_run(Study::fig5, "adaptive", 2);
  const auto file = run_file(out->path(), run.plan);
  run.plan.seed = 18'000'000'000'000'000'000u;  // A seed may be any.
  run.report["experiment"]["seed"] = run.plan.seed;
  REQUIRE(write_run(file, run));
  REQUIRE(read_run(file));

  const auto refused = [&](const FinishedRun& odd) {
    REQUIRE(write_run(file, odd));
    std::vector<std::string> notes;
    CHECK(read_runs(out->path(), {}, notes).empty());
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find(file.string()) == 0);
    return notes[0];
  };
  for (const double value : {1.7e308, -1.1e15}) {
    FinishedRun odd = run;
    odd.report["buckets"][1]["worst_server_ms"] = value;
    CHECK(refused(odd) ==
          fmt::format("{}: `buckets/1/worst_server_ms` is {:g}; expected a number from -1e+15 to "
                      "1e+15; it is left out",
                      file.string(), value));
  }
  FinishedRun odd = run;
  odd.report["`\n# a heading"] = 1e16;
  CHECK(refused(odd).find(": `?` is 1e+16; expected") != std::string::npos);
  odd = run;
  for (int n = 0; n < 1000; ++n) odd.report["deep"] = nlohmann::json::array({odd.report["deep"]});
  CHECK(refused(odd).find("expected fewer") != std::string::npos);
  odd = run;
  odd.plan.mode = "sideways";
  CHECK(refused(odd).find("`mode` of the run is wrong") != std::string::npos);
  odd = run;
  odd.build = "0.1.0` | <b>";
  CHECK(refused(odd).find("`run/build` is wrong") != std::string::npos);
}

TEST_CASE("no runs give no figures") {
  std::vector<std::string> notes;
  CHECK(figures_of({}, notes).empty());
  CHECK(notes.empty());
}
