// Figures over the number of servers: efficiency, and where a frame's time goes.
#include <fmt/format.h>

#include <algorithm>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/report_values.h"

namespace aureole {
namespace {

Scale server_scale(int largest, const std::vector<int>& counts) {
  Scale scale{"servers", 0.5, largest + 0.5, false, {}, true};
  for (const int servers : counts)
    scale.ticks.push_back({static_cast<double>(servers), std::to_string(servers)});
  return scale;
}

std::vector<int> counts_of(const StudyRuns& runs) {
  std::vector<int> counts = runs.server_counts("adaptive");
  for (const int servers : runs.server_counts("paper")) counts.push_back(servers);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

}  // namespace

void add_efficiency_figure(const StudyRuns& columns, const StudyRuns& corners,
                           std::vector<Figure>& figures, std::vector<std::string>& notes) {
  Sheet sheet;
  sheet.height = 460;
  sheet.title = "Efficiency in the last 10 s";
  double largest = 1;
  const StudyRuns* const both[] = {&columns, &corners};
  for (const StudyRuns* runs : both) {
    if (runs->runs.empty()) continue;
    sheet.subtitle = runs->setting + "; busiest server's mean frame: the limit's over ours";
    Panel panel{74 + 416.0 * static_cast<double>(sheet.panels.size()),
                130,
                362,
                270,
                runs == &columns ? "columns" : "corners",
                {},
                {},
                {},
                {},
                {}};
    for (const char* mode : {"paper", "adaptive"})
      for (const bool ideal : {true, false}) {
        Curve curve;
        curve.colour = colour_of(mode);
        curve.dash = ideal ? Dash::dashed : Dash::solid;
        curve.mark = mark_of(mode);
        for (const int servers : runs->server_counts(mode)) {
          if (!runs->find(mode, servers)->plan.references) continue;
          const auto value =
              number_at(runs->find(mode, servers)->report,
                        ideal ? "last_10_s/efficiency_ideal" : "last_10_s/efficiency");
          if (value)
            curve.points.emplace_back(servers, *value);
          else
            notes.push_back(fmt::format("efficiency: {} has no {}, its point is left out",
                                        runs->find(mode, servers)->plan.name(),
                                        ideal ? "efficiency_ideal" : "efficiency"));
          largest = std::max(largest, value.value_or(0));
        }
        panel.curves.push_back(std::move(curve));
      }
    const auto counts = counts_of(*runs);
    panel.x = server_scale(counts.back(), counts);
    panel.rules = {{0.9, "0.90"}, {0.8, "0.80"}};
    sheet.panels.push_back(std::move(panel));
  }
  if (sheet.panels.empty()) return;
  for (Panel& panel : sheet.panels) {
    panel.y = linear_scale("efficiency", largest);
    panel.y.named = &panel == &sheet.panels.front();
  }
  for (const char* mode : {"adaptive", "paper"})
    for (const bool ideal : {false, true})
      sheet.legend.push_back({fmt::format("{} / {}", mode, ideal ? "ideal" : "cut"),
                              colour_of(mode), ideal ? Dash::dashed : Dash::solid, false,
                              mark_of(mode)});
  sheet.legend.push_back({"goals: 0.90 / cut, 0.80 / ideal", "#444444", Dash::thin});
  figures.push_back(figure_of("efficiency", sheet));
}

void add_split_figure(Study study, const StudyRuns& runs, std::vector<Figure>& figures,
                      std::vector<std::string>& notes) {
  if (runs.runs.empty()) return;
  static constexpr const char* colours[] = {"#c9d3dc", colour::orange, colour::blue, colour::green};
  Sheet sheet;
  sheet.height = 640;
  sheet.title =
      fmt::format("Where a frame's time goes, {}", study == Study::fig5 ? "columns" : "corners");
  sheet.subtitle = runs.setting + "; busiest server's mean frame in the last 10 s";
  for (std::size_t part = 0; part < FrameParts::names.size(); ++part)
    sheet.legend.push_back(
        {std::string(FrameParts::names[part]), colours[part], Dash::solid, true});
  if (study == Study::fig5)
    sheet.legend.push_back({"goal of adaptive at 10 servers: 95 % physics", "#444444", Dash::thin});

  const auto counts = counts_of(runs);
  double largest = 0;
  std::size_t column = 0;
  for (const char* mode : {"paper", "adaptive"}) {
    const double left = 74 + 424.0 * static_cast<double>(column++);
    Panel absolute{left, 130, 374, 210, mode, {}, {}, {}, {}, {}};
    Panel shares{left, 376, 374, 210, "", {}, {}, {}, {}, {}};
    // Bars as wide as there is room for, evenly spaced: counts are names here.
    for (std::size_t place = 0; place < counts.size(); ++place) {
      const FinishedRun* run = runs.find(mode, counts[place]);
      if (run == nullptr) continue;
      const auto parts = last_parts(run->report);
      if (!parts || parts->total() <= 0) {
        notes.push_back(fmt::format("split: {} has no parts of its frames, its bar is left out",
                                    run->plan.name()));
        continue;
      }
      const double at = static_cast<double>(place);
      double sum = 0;
      for (std::size_t part = 0; part < parts->ms.size(); ++part) {
        const double top = sum + parts->ms[part], whole = parts->total() / 100;
        absolute.bars.push_back({at - 0.38, at + 0.38, sum, top, colours[part]});
        shares.bars.push_back({at - 0.38, at + 0.38, sum / whole, top / whole, colours[part]});
        sum = top;
      }
      largest = std::max(largest, sum);
    }
    Scale x{"servers", -0.6, static_cast<double>(counts.size()) - 0.4, false, {}, true};
    for (std::size_t place = 0; place < counts.size(); ++place)
      x.ticks.push_back({static_cast<double>(place), std::to_string(counts[place])});
    shares.x = x;
    x.label.clear();
    absolute.x = std::move(x);
    shares.y = linear_scale("share of the frame, %", 100);
    if (study == Study::fig5 && mode == std::string("adaptive")) shares.rules = {{95, "95"}};
    sheet.panels.push_back(std::move(absolute));
    sheet.panels.push_back(std::move(shares));
  }
  if (largest <= 0) return;
  for (std::size_t i = 0; i < sheet.panels.size(); ++i) {
    if (i % 2 == 0) sheet.panels[i].y = linear_scale("mean frame, ms", largest);
    sheet.panels[i].y.named = i < 2;
  }
  figures.push_back(figure_of(study == Study::fig5 ? "split-columns" : "split-corners", sheet));
}

}  // namespace aureole
