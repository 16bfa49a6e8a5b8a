// Figures over time: longest frames (Fig. 5 and Fig. 7 of the paper) and hosted bodies.
#include <fmt/format.h>

#include <algorithm>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/report_values.h"

namespace aureole {
namespace {

Points points_of(const std::vector<Sample>& samples, bool above_zero) {
  Points points;
  for (const Sample& sample : samples)
    if (!above_zero || sample.value > 0) points.emplace_back(sample.t_s, sample.value);
  return points;
}

Scale time_scale(double seconds, double room) {
  Scale scale = linear_scale("time, s", seconds);
  scale.to = seconds * room;
  std::erase_if(scale.ticks, [&](const AxisTick& tick) { return tick.at > seconds * 1.001; });
  return scale;
}

}  // namespace

void add_frame_time_figure(Study study, const StudyRuns& runs, std::vector<Figure>& figures) {
  if (runs.runs.empty()) return;
  struct Column {
    const char *mode, *reference, *title;
  };
  // `ideal` is what ran beside `adaptive`, or beside `paper` if that is all there is.
  const char* const beside = runs.server_counts("adaptive").empty() ? "paper" : "adaptive";
  const Column columns[] = {{"paper", "", "paper"},
                            {"adaptive", "", "adaptive"},
                            {beside, "ideal", "ideal: worlds that do not talk"}};
  Sheet sheet;
  sheet.height = 500;
  sheet.title = fmt::format("Longest frame of any server, {} ({} of the paper, redrawn)",
                            study == Study::fig5 ? "columns" : "corners",
                            study == Study::fig5 ? "Fig. 5" : "Fig. 7");
  sheet.subtitle = runs.setting + "; maxima of 5 s by number of servers; thin: one step, 16 ms";
  double smallest = 1e9, largest = 0, seconds = 0;
  for (std::size_t i = 0; i < std::size(columns); ++i) {
    const auto counts = runs.server_counts(columns[i].mode);
    Panel panel{
        74 + 277.0 * static_cast<double>(i), 104, 242, 340, columns[i].title, {}, {}, {}, {}, {}};
    for (std::size_t n = 0; n < counts.size(); ++n) {
      const FinishedRun& run = *runs.find(columns[i].mode, counts[n]);
      Curve curve;
      // One server is its own ideal.
      const char* const source = run.plan.references ? columns[i].reference : "";
      curve.points = points_of(by_bucket(buckets_of(run.report, source), "max_frame_ms"), true);
      curve.colour = ordered_colour(n, counts.size());
      curve.label = std::to_string(counts[n]);
      for (const auto& [t_s, ms] : curve.points) {
        smallest = std::min(smallest, ms);
        largest = std::max(largest, ms);
        seconds = std::max(seconds, t_s);
      }
      panel.curves.push_back(std::move(curve));
    }
    sheet.panels.push_back(std::move(panel));
  }
  if (largest <= 0) return;
  const Scale ms = log_scale("longest frame, ms (logarithmic)", smallest * 0.85, largest * 1.25);
  for (Panel& panel : sheet.panels) {
    panel.x = time_scale(seconds, 1.1);
    panel.y = ms;
    panel.y.named = &panel == &sheet.panels.front();
    panel.rules = {{16, ""}};
  }
  figures.push_back(figure_of(std::string(word_of(study)), sheet));
}

void add_hosted_figure(const StudyRuns& columns, std::vector<Figure>& figures) {
  Sheet sheet;
  sheet.height = 640;
  sheet.title = "Bodies that each server hosts, columns";
  sheet.subtitle =
      columns.setting + "; r0 is the leftmost server, dashed: the same region in ideal";
  double row = 0;
  for (const int servers : {2, 4}) {
    double largest = 0, seconds = 0;
    const std::size_t first = sheet.panels.size();
    for (const char* mode : {"paper", "adaptive"}) {
      const FinishedRun* run = columns.find(mode, servers);
      if (run == nullptr) continue;
      const double left = 74 + 420.0 * static_cast<double>(sheet.panels.size() - first);
      Panel panel{left,
                  104 + 270 * row,
                  366,
                  208,
                  fmt::format("{}, {}", mode, servers_in_words(servers)),
                  {},
                  {},
                  {},
                  {},
                  {}};
      const char* const sources[] = {"ideal", ""};
      for (const char* source : sources) {
        const auto hosted = bodies_by_server(buckets_of(run->report, source));
        const bool ours = *source == '\0';
        for (std::size_t server = 0; server < hosted.size(); ++server) {
          Curve curve;
          curve.points = points_of(hosted[server], false);
          curve.colour = ordered_colour(server, hosted.size());
          curve.dash = ours ? Dash::solid : Dash::dashed;
          curve.width = ours ? 2.2 : 1;
          if (ours) curve.label = fmt::format("r{}", server);
          for (const auto& [t_s, bodies] : curve.points) {
            seconds = std::max(seconds, t_s);
            largest = std::max(largest, bodies);
          }
          panel.curves.push_back(std::move(curve));
        }
      }
      sheet.panels.push_back(std::move(panel));
    }
    if (sheet.panels.size() == first) continue;
    for (std::size_t i = first; i < sheet.panels.size(); ++i) {
      sheet.panels[i].x = time_scale(seconds, 1.08);
      if (servers == 2) sheet.panels[i].x.label.clear();
      sheet.panels[i].y = linear_scale("bodies", largest);
      sheet.panels[i].y.named = i == first;
    }
    ++row;
  }
  if (sheet.panels.empty()) return;
  sheet.height = static_cast<int>(104 + 270 * row);
  figures.push_back(figure_of("hosted", sheet));
}

}  // namespace aureole
