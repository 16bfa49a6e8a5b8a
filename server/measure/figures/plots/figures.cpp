// Which runs go together, and the list of figures.
#include "server/measure/figures/plots/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace aureole {
namespace {

/// What all runs of a figure must have in common.
using Setting = std::tuple<double, double, std::uint64_t>;

Setting setting_of(const PlannedRun& run) {
  return {run.seconds, run.rate_per_s, run.seed};
}

/// The one with the largest count; of several the largest.
template <class Key>
Key most_common(const std::map<Key, std::size_t>& counts) {
  const auto most = std::max_element(counts.begin(), counts.end(), [](auto& a, auto& b) {
    return std::tie(a.second, a.first) < std::tie(b.second, b.first);
  });
  return most->first;
}

std::string in_words(int repeats) {
  return repeats == 1 ? std::string("run once") : fmt::format("mean of {} repeats", repeats);
}

std::string in_words(const PlannedRun& run, const std::string& repeats) {
  return fmt::format("{:g} s at {:g} bodies/s{}, {}, seed {}", run.seconds, run.rate_per_s,
                     run.study == Study::weak ? " for every 4 servers" : "", repeats, run.seed);
}

/// By mode, since what is asked of maxima is asked of one of them only.
std::string in_words(const std::map<std::string, int>& repeats) {
  std::set<int> different;
  std::string all;
  for (const auto& [mode, count] : repeats) {
    different.insert(count);
    all += fmt::format("{}{}: {}", all.empty() ? "" : ", ", mode, in_words(count));
  }
  return different.size() == 1 ? in_words(*different.begin()) : all;
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

bool is_of(Study study, const PlannedRun& run) {
  const auto is_figure = [](Study s) { return s == Study::fig5 || s == Study::fig7; };
  return run.study == study || (run.servers == 1 && is_figure(study) && is_figure(run.study));
}

StudyRuns runs_of(Study study, const std::vector<FinishedRun>& runs,
                  std::vector<std::string>& notes) {
  std::map<Setting, std::size_t> settings;
  for (const FinishedRun& run : runs)
    if (is_of(study, run.plan)) ++settings[setting_of(run.plan)];
  StudyRuns chosen;
  if (settings.empty()) return chosen;
  const Setting setting = most_common(settings);
  std::map<std::string, std::map<int, std::size_t>> counts;  // Of repeats, by mode.
  for (const FinishedRun& run : runs)
    if (is_of(study, run.plan) && setting_of(run.plan) == setting)
      ++counts[run.plan.mode][run.plan.repeats];
  std::map<std::string, int> repeats;
  for (const auto& [mode, of_mode] : counts) repeats[mode] = most_common(of_mode);
  const auto belongs = [&](const PlannedRun& plan) {
    return setting_of(plan) == setting && plan.repeats == repeats.at(plan.mode);
  };
  for (const FinishedRun& run : runs) {
    if (!is_of(study, run.plan) || !belongs(run.plan)) continue;
    // Of two of one server the one that was made for this study.
    const auto same =
        std::find_if(chosen.runs.begin(), chosen.runs.end(), [&](const FinishedRun* other) {
          return run.plan.servers == 1 && other->plan.servers == 1 &&
                 other->plan.mode == run.plan.mode;
        });
    if (same == chosen.runs.end())
      chosen.runs.push_back(&run);
    else if (run.plan.study == study)
      *same = &run;
    chosen.setting = in_words(run.plan, in_words(repeats));
  }
  for (const FinishedRun& run : runs)
    if (run.plan.study == study && !belongs(run.plan))
      notes.push_back(fmt::format("{} is left out: it is {}, most of {} are {}", run.plan.name(),
                                  in_words(run.plan, in_words(run.plan.repeats)), word_of(study),
                                  chosen.setting));
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
  add_regions_figure(runs_of(Study::regions, runs, notes), figures, notes);
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
