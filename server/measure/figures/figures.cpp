// Which runs go together, and the list of figures.
#include "server/measure/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace aureole {
namespace {

using Setting = std::tuple<double, double, int, std::uint64_t>;

Setting setting_of(const PlannedRun& run) {
  return {run.seconds, run.rate_per_s, run.repeats, run.seed};
}

std::string in_words(const PlannedRun& run) {
  return fmt::format(
      "{:g} s at {:g} bodies/s{}, {}, seed {}", run.seconds, run.rate_per_s,
      run.study == Study::weak ? " for every 4 servers" : "",
      run.repeats == 1 ? std::string("run once") : fmt::format("mean of {} repeats", run.repeats),
      run.seed);
}

}  // namespace

const FinishedRun* StudyRuns::find(const std::string& mode, int servers) const {
  for (const FinishedRun* run : runs)
    if (run->plan.mode == mode && run->plan.servers == servers) return run;
  return nullptr;
}

std::vector<int> StudyRuns::server_counts(const std::string& mode) const {
  std::set<int> counts;
  for (const FinishedRun* run : runs)
    if (run->plan.mode == mode) counts.insert(run->plan.servers);
  return {counts.begin(), counts.end()};
}

StudyRuns runs_of(Study study, const std::vector<FinishedRun>& runs,
                  std::vector<std::string>& notes) {
  std::map<Setting, std::size_t> settings;
  for (const FinishedRun& run : runs)
    if (run.plan.study == study) ++settings[setting_of(run.plan)];
  StudyRuns chosen;
  if (settings.empty()) return chosen;
  // Of equally many the longer ones.
  const auto most =
      std::max_element(settings.begin(), settings.end(), [](const auto& a, const auto& b) {
        return std::tie(a.second, a.first) < std::tie(b.second, b.first);
      });
  for (const FinishedRun& run : runs) {
    if (run.plan.study != study) continue;
    if (setting_of(run.plan) == most->first) {
      chosen.runs.push_back(&run);
      chosen.setting = in_words(run.plan);
    }
  }
  for (const FinishedRun& run : runs)
    if (run.plan.study == study && setting_of(run.plan) != most->first)
      notes.push_back(fmt::format("{} is left out: it is {}, most of {} are {}", run.plan.name(),
                                  in_words(run.plan), word_of(study), chosen.setting));
  return chosen;
}

std::vector<Figure> figures_of(const std::vector<FinishedRun>& runs,
                               std::vector<std::string>& notes) {
  std::vector<Figure> figures;
  const StudyRuns columns = runs_of(Study::fig5, runs, notes),
                  corners = runs_of(Study::fig7, runs, notes);
  add_frame_time_figure(Study::fig5, columns, figures);
  add_frame_time_figure(Study::fig7, corners, figures);
  add_efficiency_figure(columns, corners, figures, notes);
  add_split_figure(Study::fig5, columns, figures, notes);
  add_split_figure(Study::fig7, corners, figures, notes);
  add_hosted_figure(columns, figures);
  add_latency_figure(runs_of(Study::latency, runs, notes), figures, notes);
  add_tolerances_figure(runs_of(Study::tolerances, runs, notes), figures, notes);
  add_weak_figure(runs_of(Study::weak, runs, notes), figures, notes);
  return figures;
}

Figure figure_of(std::string name, const Sheet& sheet) {
  return {std::move(name), sheet.title + ". " + sheet.subtitle, script_of(sheet)};
}

std::string colour_of(const std::string& mode) {
  return mode == "adaptive" ? colour::blue : mode == "paper" ? colour::vermilion : colour::grey;
}

PointMark mark_of(const std::string& mode) {
  return mode == "paper" ? PointMark::square : PointMark::circle;
}

std::string servers_in_words(int servers) {
  return servers == 1 ? "1 server" : fmt::format("{} servers", servers);
}

}  // namespace aureole
