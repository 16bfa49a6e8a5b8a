// The demands: what meets each of them, and what just fails.
#include <algorithm>
#include <map>

#include "server/measure/figures/tables.h"
#include "tests/support/catch.h"
#include "tests/unit/measure/figures/small_runs.h"

using namespace aureole;

namespace {

/// The one whose text contains all of the words.
BarResult bar(const std::vector<FinishedRun>& runs, const std::vector<std::string>& words) {
  std::vector<BarResult> found;
  for (BarResult& result : bars_of(runs))
    if (std::all_of(words.begin(), words.end(), [&](const std::string& word) {
          return result.bar.find(word) != std::string::npos;
        }))
      found.push_back(std::move(result));
  REQUIRE(found.size() == 1);
  return found.front();
}

Verdict verdict(const std::vector<FinishedRun>& runs, const std::vector<std::string>& words) {
  return bar(runs, words).verdict;
}

}  // namespace

TEST_CASE("runs that meet every demand pass all of them") {
  for (const BarResult& result : bars_of(small_runs())) {
    CAPTURE(result.bar, result.came);
    CHECK(result.verdict == Verdict::passed);
  }
}

TEST_CASE("without runs nothing is judged, and every demand is listed") {
  const auto bars = bars_of({});
  CHECK(bars.size() == bars_of(small_runs()).size());
  for (const BarResult& result : bars) {
    CAPTURE(result.bar);
    CHECK(result.verdict == Verdict::unknown);
  }
}

TEST_CASE("an efficiency just below its bar fails, that of paper is not asked for") {
  auto runs = small_runs();
  run_among(runs, Study::fig5, "adaptive", 4).report["last_10_s"]["efficiency"] = 0.899;
  run_among(runs, Study::fig7, "adaptive", 9).report["last_10_s"]["efficiency_ideal"] = 0.799;
  run_among(runs, Study::fig5, "paper", 4).report["last_10_s"]["efficiency"] = 0.1;
  CHECK(bar(runs, {"columns 4:", "`cut`"}).came == "0.899");
  CHECK(verdict(runs, {"columns 4:", "`cut`"}) == Verdict::failed);
  CHECK(verdict(runs, {"corners 9:", "`ideal`"}) == Verdict::failed);
  CHECK(verdict(runs, {"columns 4:", "`ideal`"}) == Verdict::passed);
  run_among(runs, Study::fig5, "adaptive", 4).report["last_10_s"]["efficiency"] = 0.9;
  CHECK(verdict(runs, {"columns 4:", "`cut`"}) == Verdict::passed);
}

TEST_CASE("more than 5 % besides physics at 10 columns fails") {
  auto runs = small_runs();
  auto& share = run_among(runs, Study::fig5, "adaptive", 10).report["last_10_s"];
  share["share_besides_physics"] = 0.0501;
  CHECK(verdict(runs, {"auras, decisions and wire"}) == Verdict::failed);
}

TEST_CASE("one bucket that does not fall fails its step, unless it is in the first 10 s") {
  auto runs = small_runs();
  auto& buckets = run_among(runs, Study::fig5, "adaptive", 4).report["buckets"];
  buckets[1]["worst_server_ms"] = 1000;
  CHECK(verdict(runs, {"columns 2 → 4", "worst_server_ms"}) == Verdict::passed);
  // As slow as two servers: no gain.
  buckets[2]["worst_server_ms"] = 7.5;
  const BarResult fall = bar(runs, {"columns 2 → 4", "worst_server_ms"});
  CHECK(fall.verdict == Verdict::failed);
  CHECK(fall.came == "in 1 of 2; 15 s: 7.50 → 7.50 ms");
  CHECK(verdict(runs, {"columns 2 → 4", "max_frame_ms"}) == Verdict::passed);
  CHECK(verdict(runs, {"columns 1 → 2", "worst_server_ms"}) == Verdict::passed);
}

TEST_CASE("maxima of fewer than five repeats are told but not judged") {
  auto runs = small_runs();
  run_among(runs, Study::fig7, "adaptive", 9).plan.repeats = 4;
  CHECK(verdict(runs, {"corners 4 → 9", "max_frame_ms"}) == Verdict::unknown);
  CHECK(verdict(runs, {"corners 4 → 9", "worst_server_ms"}) == Verdict::passed);
  CHECK(verdict(runs, {"corners 1 → 4", "max_frame_ms"}) == Verdict::passed);
}

TEST_CASE("one missed interaction, lost body or doubled body in any run fails, and names it") {
  auto runs = small_runs();
  auto& run = run_among(runs, Study::weak, "adaptive", 16);
  run.report["buckets"][0]["missed_interactions_in_tolerance"] = 2;
  run_among(runs, Study::fig7, "paper", 4).report["bodies_lost"] = 1;
  run_among(runs, Study::fig7, "adaptive", 9).report["bodies_duplicated"] = 1;
  CHECK(bar(runs, {"`adaptive`", "missed"}).came == "2 in weak-grid-16-adaptive; 8 runs judged");
  CHECK(verdict(runs, {"`adaptive`", "missed"}) == Verdict::failed);
  CHECK(verdict(runs, {"`paper`", "missed"}) == Verdict::passed);
  CHECK(verdict(runs, {"`paper`", "lost"}) == Verdict::failed);
  CHECK(verdict(runs, {"`adaptive`", "lost"}) == Verdict::passed);
  CHECK(verdict(runs, {"`adaptive`", "doubled"}) == Verdict::failed);
}

TEST_CASE("runs that no oracle has looked at are not counted as judged") {
  auto runs = small_runs();
  for (FinishedRun& run : runs)
    if (run.plan.mode == "paper")
      for (auto& bucket : run.report["buckets"])
        bucket["missed_interactions_in_tolerance"] = nullptr;
  CHECK(verdict(runs, {"`paper`", "missed"}) == Verdict::unknown);
}

TEST_CASE("one run with too many bytes fails") {
  for (const auto& [key, words] :
       std::map<std::string, std::string>{{"aura_bytes_per_moving_tick", "moving aura"},
                                          {"replica_bytes_per_moving_tick", "moving replica"},
                                          {"replica_key_share", "key states"}}) {
    CAPTURE(key);
    auto runs = small_runs();
    auto& value = run_among(runs, Study::fig7, "paper", 9).report["total"]["wire"][key];
    value = value.get<double>() * 1.001;
    CHECK(verdict(runs, {words}) == Verdict::failed);
    CHECK(bar(runs, {words}).came.find("fig7-corner-09-paper") != std::string::npos);
  }
}

TEST_CASE("a median server that takes more than 10 % longer in weak scaling fails") {
  auto runs = small_runs();
  auto& last = run_among(runs, Study::weak, "adaptive", 64).report["last_10_s"];
  last["median_server_ms"] = 17.5 * 1.09;
  CHECK(verdict(runs, {"weak scaling"}) == Verdict::passed);
  last["median_server_ms"] = 17.5 * 1.11;
  CHECK(verdict(runs, {"weak scaling"}) == Verdict::failed);
}

TEST_CASE("weak scaling is judged with cold caches, and says what came with shared ones") {
  auto runs = small_runs();
  for (const int servers : {4, 64}) {
    FinishedRun& run = run_among(runs, Study::weak, "adaptive", servers);
    run.plan.cold_caches_s = 10;
    run.report["last_10_s"]["median_server_ms"] = servers == 4 ? 20 : 21;
    for (std::size_t b : {0, 1})
      run.report["buckets"][b]["server_ms"] = {servers == 4 ? 10 : 13, servers == 4 ? 10 : 13};
  }
  CHECK(verdict(runs, {"weak scaling"}) == Verdict::passed);
  CHECK(bar(runs, {"weak scaling"}).came ==
        "+5.0 % (20.000 → 21.000 ms; caches cold; with shared ones before that +30.0 %, "
        "10.000 → 13.000 ms)");
}

TEST_CASE("the page tells what was run, what failed, and what was left out") {
  auto runs = small_runs();
  run_among(runs, Study::fig5, "adaptive", 2).report["last_10_s"]["efficiency"] = 0.5;
  const std::string page = tables_of(runs, {"a point is left out"});
  for (const char* part :
       {"from 17 runs of build `0.0.0 test`", "a trial, no result", ", 1 failed, 0 not judged",
        "| `adaptive`, columns 2: last 10 s against `cut` | at least 0.90 | 0.500 | **FAIL** |",
        "## Columns: last 10 s", "## Corners: last 10 s", "| 10 | `adaptive` | 1.75 |",
        "- a point is left out"}) {
    CAPTURE(part);
    CHECK(page.find(part) != std::string::npos);
  }
  for (FinishedRun& run : runs) run.plan.seconds = 60;
  CHECK(tables_of(runs, {}).find("a trial") == std::string::npos);
}
