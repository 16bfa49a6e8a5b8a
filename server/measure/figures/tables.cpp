// The page of tables.
#include "server/measure/figures/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/report_values.h"

namespace aureole {
namespace {

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "pass";
    case Verdict::failed:
      return "**FAIL**";
    case Verdict::unknown:
      return "not judged";
  }
  return "";
}

std::string cell(std::optional<double> value, int digits, double factor = 1) {
  return value ? fmt::format("{:.{}f}", *value * factor, digits) : "–";
}

/// Of all ticks of all servers; of frames, where servers do not keep it.
std::optional<double> inside_share(const nlohmann::json& report) {
  const auto ticks = number_at(report, "total/ticks_in_tolerance_share");
  return ticks ? ticks : number_at(report, "total/frames_in_tolerance_share");
}

void add_study(Study study, const std::vector<FinishedRun>& runs, std::string& page) {
  std::vector<std::string> left_out;  // They are told once, with the figures.
  const StudyRuns chosen = runs_of(study, runs, left_out);
  if (chosen.runs.empty()) return;
  page += fmt::format(
      "\n## {}: last 10 s\n\n{}. Busiest server's mean frame and its parts; inside: share of the "
      "run's ticks inside the tolerances.\n\n"
      "| servers | mode | frame, ms | physics | aura | decide | wire | speedup | / cut | / ideal | "
      "inside | changes of owner | missed | in tolerance |\n"
      "|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      study == Study::fig5 ? "Columns" : "Corners", chosen.setting);
  for (const FinishedRun* run : chosen.runs) {
    const auto& report = run->report;
    const FrameParts parts = last_parts(report).value_or(FrameParts{});
    page += fmt::format(
        "| {} | `{}` | {} | {:.2f} | {:.3f} | {:.3f} | {:.3f} | {} | {} | {} | {} % | {} | {} | {} "
        "|\n",
        run->plan.servers, run->plan.mode, cell(number_at(report, "last_10_s/worst_server_ms"), 2),
        parts.ms[0], parts.ms[1], parts.ms[2], parts.ms[3],
        cell(number_at(report, "last_10_s/speedup"), 2),
        cell(number_at(report, "last_10_s/efficiency"), 3),
        cell(number_at(report, "last_10_s/efficiency_ideal"), 3),
        cell(inside_share(report), 1, 100), cell(sum_of(report, "migrations"), 0),
        cell(sum_of(report, "missed_interactions"), 0),
        cell(sum_of(report, "missed_interactions_in_tolerance"), 0));
  }
}

/// Less than the paper's workload says nothing about the paper's figures.
bool is_small(const FinishedRun& run) {
  return (run.plan.study == Study::fig5 || run.plan.study == Study::fig7) &&
         (run.plan.seconds < 60 || run.plan.rate_per_s < 160);
}

}  // namespace

std::string tables_of(const std::vector<FinishedRun>& runs, const std::vector<std::string>& notes) {
  std::string page = "# Experiments: what was demanded, and what came\n\n";
  std::set<std::string> builds;
  for (const FinishedRun& run : runs) builds.insert(run.build);
  page += fmt::format("Written by `aureole experiment figures` from {} runs", runs.size());
  for (const std::string& build : builds)
    page += fmt::format("{}`{}`", build == *builds.begin() ? " of build " : " and ", build);
  page += ".\n";
  if (std::any_of(runs.begin(), runs.end(), is_small))
    page +=
        "**The workload is smaller than the paper's (60 s at 160 bodies/s): what follows is a "
        "trial, no result.**\n";

  const auto bars = bars_of(runs);
  const auto count = [&](Verdict verdict) {
    return std::count_if(bars.begin(), bars.end(),
                         [&](const BarResult& bar) { return bar.verdict == verdict; });
  };
  page += fmt::format(
      "\n{} passed, {} failed, {} not judged.\n\n| demand | wanted | came | |\n|---|---|---|---|\n",
      count(Verdict::passed), count(Verdict::failed), count(Verdict::unknown));
  for (const BarResult& bar : bars)
    page +=
        fmt::format("| {} | {} | {} | {} |\n", bar.bar, bar.wanted, bar.came, word_of(bar.verdict));
  add_study(Study::fig5, runs, page);
  add_study(Study::fig7, runs, page);
  if (!notes.empty()) page += "\n## Left out\n\n";
  for (const std::string& note : notes) page += "- " + note + "\n";
  return page;
}

}  // namespace aureole
