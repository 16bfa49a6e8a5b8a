// Figures of the studies that the paper left for later: networks, tolerances, weak scaling.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <span>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/report_values.h"

namespace aureole {
namespace {

using Value = std::function<std::optional<double>(const nlohmann::json&)>;

/// What is measured: a row of panels.
struct Quantity {
  const char* label;
  Value value;
};

/// What is varied: a column of panels.
struct Varied {
  const char *title, *label;
  std::function<bool(const PlannedRun&)> belongs;
  std::function<double(const PlannedRun&)> value;
  bool logarithmic;
};

std::string kind_of(const PlannedRun& run) {
  return run.mode + (run.tolerances.follow ? ", tolerances follow" : "");
}

std::vector<Quantity> quantities() {
  return {{"missed interactions",
           [](const auto& report) { return sum_of(report, "missed_interactions"); }},
          {"changes of owner", [](const auto& report) { return sum_of(report, "migrations"); }},
          {"jump at handoff (p99), mm",
           [](const auto& report) { return number_at(report, "total/handoff_jump_mm/p99"); }},
          {"busiest server's frame, ms",
           [](const auto& report) { return number_at(report, "last_10_s/worst_server_ms"); }}};
}

Scale varied_scale(const Varied& varied, const StudyRuns& runs) {
  std::vector<double> values;
  for (const FinishedRun* run : runs.runs)
    if (varied.belongs(run->plan)) values.push_back(varied.value(run->plan));
  std::sort(values.begin(), values.end());
  if (values.empty()) return linear_scale(varied.label, 1);
  if (!varied.logarithmic) {
    Scale scale = linear_scale(varied.label, values.back());
    scale.to = std::max(values.back(), 1e-3) * 1.04;
    std::erase_if(scale.ticks, [&](const AxisTick& tick) { return tick.at > scale.to; });
    return scale;
  }
  values.erase(std::unique(values.begin(), values.end()), values.end());
  Scale scale{varied.label, values.front() / 1.3, values.back() * 1.3, true, {}, true};
  for (const double value : values) scale.ticks.push_back({value, fmt::format("{:g}", value)});
  return scale;
}

/// Columns of what is varied, rows of what is measured, the same y axis along a row.
Sheet grid_of(const StudyRuns& runs, const std::vector<Varied>& columns,
              const std::vector<Quantity>& rows, std::vector<std::string>& notes) {
  struct Look {
    const char *kind, *colour;
    Dash dash;
    PointMark mark;
  };
  // The last one is on top.
  static constexpr Look looks[] = {
      {"paper", colour::vermilion, Dash::solid, PointMark::square},
      {"adaptive", colour::blue, Dash::solid, PointMark::circle},
      {"adaptive, tolerances follow", colour::green, Dash::dashed, PointMark::triangle}};
  Sheet sheet;
  const double wide = (900.0 - 74 + 12) / static_cast<double>(columns.size());
  double top = 132;
  for (const Quantity& quantity : rows) {
    std::vector<Panel> row;
    double largest = 0;
    std::size_t missing = 0;
    for (const Varied& varied : columns) {
      Panel panel{74 + wide * static_cast<double>(row.size()),
                  top,
                  wide - 36,
                  140,
                  &quantity == &rows.front() ? varied.title : "",
                  varied_scale(varied, runs),
                  {},
                  {},
                  {},
                  {}};
      panel.x.named = true;
      for (const Look& look : looks) {
        Curve curve{{}, look.colour, look.dash, look.mark, "", 2};
        for (const FinishedRun* run : runs.runs) {
          if (!varied.belongs(run->plan) || kind_of(run->plan) != look.kind) continue;
          const auto value = quantity.value(run->report);
          if (value)
            curve.points.emplace_back(varied.value(run->plan), *value);
          else
            ++missing;
          largest = std::max(largest, value.value_or(0));
        }
        std::sort(curve.points.begin(), curve.points.end());
        panel.curves.push_back(std::move(curve));
      }
      row.push_back(std::move(panel));
    }
    if (missing > 0)
      notes.push_back(fmt::format("{}, {}: {} points are left out, their runs do not tell it",
                                  word_of(runs.runs.front()->plan.study), quantity.label, missing));
    const bool any = std::any_of(row.begin(), row.end(), [](const Panel& panel) {
      return std::any_of(panel.curves.begin(), panel.curves.end(),
                         [](const Curve& curve) { return !curve.points.empty(); });
    });
    if (!any) continue;
    for (Panel& panel : row) {
      panel.y = linear_scale(quantity.label, largest * 1.05);
      panel.y.named = &panel == &row.front();
      sheet.panels.push_back(std::move(panel));
    }
    top += 178;
  }
  // Only the lowest row tells what is varied.
  for (std::size_t i = 0; i + columns.size() < sheet.panels.size(); ++i)
    sheet.panels[i].x.label.clear();
  sheet.height = static_cast<int>(top + 24);
  for (const Look& look : looks)
    if (std::any_of(runs.runs.begin(), runs.runs.end(),
                    [&](const FinishedRun* run) { return kind_of(run->plan) == look.kind; }))
      sheet.legend.push_back({look.kind, look.colour, look.dash, false, look.mark});
  return sheet;
}

std::string where(const StudyRuns& runs) {
  const PlannedRun& run = runs.runs.front()->plan;
  return fmt::format("{}, {}; {}", run.layout, servers_in_words(run.servers), runs.setting);
}

}  // namespace

void add_latency_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                        std::vector<std::string>& notes) {
  if (runs.runs.empty()) return;
  const auto even = [](const PlannedRun& run) { return run.network.jitter_ms == 0; };
  const auto lossless = [](const PlannedRun& run) { return run.network.loss_pct == 0; };
  // Jitter and loss are varied at one latency; the run with neither belongs to all three.
  double base_ms = 20;
  for (const FinishedRun* run : runs.runs)
    if (!even(run->plan) || !lossless(run->plan)) base_ms = run->plan.network.latency_ms;
  const auto at_base = [=](const PlannedRun& run) { return run.network.latency_ms == base_ms; };
  const std::string jitter = fmt::format("jitter at {:g} ms latency", base_ms),
                    loss = fmt::format("packet loss at {:g} ms latency", base_ms);
  Sheet sheet = grid_of(
      runs,
      {{"latency", "latency, ms", [=](const PlannedRun& run) { return even(run) && lossless(run); },
        [](const PlannedRun& run) { return run.network.latency_ms; }, false},
       {jitter.c_str(), "jitter, ms",
        [=](const PlannedRun& run) { return at_base(run) && lossless(run); },
        [](const PlannedRun& run) { return run.network.jitter_ms; }, false},
       {loss.c_str(), "packets lost, %",
        [=](const PlannedRun& run) { return at_base(run) && even(run); },
        [](const PlannedRun& run) { return run.network.loss_pct; }, false}},
      quantities(), notes);
  if (sheet.panels.empty()) return;
  sheet.title = "What slow, uneven and lossy networks do";
  sheet.subtitle = where(runs) + "; counts over the whole run";
  figures.push_back(figure_of("latency", sheet));
}

void add_tolerances_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                           std::vector<std::string>& notes) {
  if (runs.runs.empty()) return;
  // The latency tolerance is varied on a slower network, so that it can be too small.
  double fast_ms = 1e9, slow_ms = 0;
  for (const FinishedRun* run : runs.runs) {
    fast_ms = std::min(fast_ms, run->plan.network.latency_ms);
    slow_ms = std::max(slow_ms, run->plan.network.latency_ms);
  }
  const std::string speed = fmt::format("speed tolerance, network of {:g} ms", fast_ms),
                    latency = fmt::format("latency tolerance, network of {:g} ms", slow_ms);
  Sheet sheet = grid_of(runs,
                        {{speed.c_str(), "speed tolerance, m/s",
                          [=](const PlannedRun& run) {
                            return run.network.latency_ms == fast_ms &&
                                   run.tolerances.latency_ms == PlannedTolerances{}.latency_ms;
                          },
                          [](const PlannedRun& run) { return run.tolerances.speed_mps; }, true},
                         {latency.c_str(), "latency tolerance, ms",
                          [=](const PlannedRun& run) {
                            return run.network.latency_ms == slow_ms &&
                                   run.tolerances.speed_mps == PlannedTolerances{}.speed_mps;
                          },
                          [](const PlannedRun& run) { return run.tolerances.latency_ms; }, true}},
                        quantities(), notes);
  if (sheet.panels.empty()) return;
  sheet.title = "What a larger aura costs, and what a smaller one misses";
  sheet.subtitle = where(runs) + "; counts over the whole run";
  figures.push_back(figure_of("tolerances", sheet));
}

void add_weak_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                     std::vector<std::string>& notes) {
  if (runs.runs.empty()) return;
  Curve median{{}, colour::blue, Dash::solid, PointMark::circle, "", 2},
      worst{{}, colour::sky, Dash::solid, PointMark::triangle, "", 2},
      shared{{}, colour::grey, Dash::dashed, PointMark::circle, "", 2},
      bytes{{}, colour::green, Dash::solid, PointMark::circle, "", 2};
  for (const FinishedRun* run : runs.runs) {
    const double servers = run->plan.servers;
    const auto note = [&](Curve& curve, const char* what, std::optional<double> value) {
      if (value)
        curve.points.emplace_back(servers, *value);
      else
        notes.push_back(fmt::format("weak scaling: {} has no {}, its point is left out",
                                    run->plan.name(), what));
    };
    note(median, "times of its servers", median_server_ms(run->report));
    note(worst, "worst_server_ms", number_at(run->report, "last_10_s/worst_server_ms"));
    if (run->plan.cold_caches_s > 0)
      note(shared, "times of its servers before", median_server_ms_before(run->report));
    const auto sent = bytes_per_server_and_s(run->report);
    note(bytes, "bytes of its links", sent ? std::optional(*sent / 1e3) : std::nullopt);
  }
  Sheet sheet;
  sheet.height = 430;
  sheet.title = "Weak scaling: bodies grow with servers";
  sheet.subtitle = runs.setting;
  Scale x{"servers (logarithmic)", 3, 110, true, {}, true};
  for (const int servers : runs.server_counts("adaptive"))
    x.ticks.push_back({static_cast<double>(servers), std::to_string(servers)});
  const auto largest = [](const Curve& curve) {
    double most = 0;
    for (const auto& point : curve.points) most = std::max(most, point.second);
    return most;
  };
  Panel frames{
      74,
      134,
      360,
      236,
      "a server's mean frame in the last 10 s",
      x,
      linear_scale("ms", 1.05 * std::max({largest(median), largest(worst), largest(shared)})),
      {},
      {},
      {}};
  if (!median.points.empty()) {
    const double goal = median.points.front().second;
    frames.bars = {{x.from, x.to, goal * 0.9, goal * 1.1, "#dce9f3"}};
    sheet.legend.push_back({"within 10 % of the first", "#dce9f3", Dash::solid, true});
  }
  frames.curves = {worst, median};
  const auto explain = [&](const Curve& curve, const char* label) {
    sheet.legend.push_back({label, curve.colour, curve.dash, false, curve.mark});
  };
  explain(worst, "busiest server");
  explain(median, "median server");
  if (!shared.points.empty()) {
    sheet.subtitle += "; caches are cold, but in the 10 s before they are shared";
    explain(shared, "median in the 10 s before");
    frames.curves.push_back(shared);
  }
  Panel wire{514,
             134,
             360,
             236,
             "what a server sends, to servers and gateway",
             x,
             linear_scale("kB/s", 1.05 * largest(bytes)),
             {},
             {},
             {}};
  wire.curves = {bytes};
  sheet.panels = {std::move(frames), std::move(wire)};
  figures.push_back(figure_of("weak", sheet));
}

void add_regions_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                        std::vector<std::string>& notes) {
  if (runs.runs.empty()) return;
  struct Layout {
    const char *layout, *colour;
    PointMark mark;
  };
  static constexpr Layout layouts[] = {{"column", colour::orange, PointMark::square},
                                       {"corner", colour::blue, PointMark::circle}};
  struct Part {
    const char *title, *label, *key;
    Dash dash;
    double factor;
  };
  static constexpr Part efficiencies[] = {
      {"the limit's frame over ours", "efficiency", "last_10_s/efficiency", Dash::solid, 1},
      {"", "", "last_10_s/efficiency_ideal", Dash::dashed, 1}};
  static constexpr Part besides[] = {{"auras, decisions and wire", "% of a frame",
                                      "last_10_s/share_besides_physics", Dash::solid, 100}};
  std::vector<double> edges_m;
  for (const FinishedRun* run : runs.runs) edges_m.push_back(run->plan.region_m);
  std::sort(edges_m.begin(), edges_m.end());
  edges_m.erase(std::unique(edges_m.begin(), edges_m.end()), edges_m.end());
  Scale x{"edge of a region, m", edges_m.front() - 20, edges_m.back() + 20, false, {}, true};
  for (const double edge_m : edges_m) x.ticks.push_back({edge_m, fmt::format("{:g}", edge_m)});

  Sheet sheet;
  sheet.height = 430;
  sheet.title = "How large regions are";
  sheet.subtitle = runs.setting + "; last 10 s, busiest server";
  const auto add_panel = [&](std::span<const Part> parts, std::vector<Rule> rules) {
    Panel panel{74 + 440.0 * static_cast<double>(sheet.panels.size()),
                134,
                360,
                236,
                parts.front().title,
                x,
                {},
                {},
                {},
                std::move(rules)};
    double largest = 0;
    for (const Part& part : parts)
      for (const Layout& layout : layouts) {
        Curve curve{{}, layout.colour, part.dash, layout.mark, "", 2};
        for (const FinishedRun* run : runs.runs) {
          if (run->plan.layout != layout.layout) continue;
          const auto value = number_at(run->report, part.key);
          if (value)
            curve.points.emplace_back(run->plan.region_m, part.factor * *value);
          else
            notes.push_back(fmt::format("regions: {} has no {}, its point is left out",
                                        run->plan.name(), part.key));
          largest = std::max(largest, part.factor * value.value_or(0));
        }
        std::sort(curve.points.begin(), curve.points.end());
        panel.curves.push_back(std::move(curve));
      }
    for (const Rule& rule : panel.rules) largest = std::max(largest, rule.at);
    panel.y = linear_scale(parts.front().label, 1.05 * largest);
    sheet.panels.push_back(std::move(panel));
  };
  add_panel(efficiencies, {{0.9, "0.90"}, {0.8, "0.80"}});
  add_panel(besides, {});
  for (const Layout& layout : layouts) {
    const auto shown =
        std::find_if(runs.runs.begin(), runs.runs.end(),
                     [&](const FinishedRun* run) { return run->plan.layout == layout.layout; });
    if (shown == runs.runs.end()) continue;
    sheet.legend.push_back({fmt::format("{} of {}", layout.layout, (*shown)->plan.servers),
                            layout.colour, Dash::solid, false, layout.mark});
  }
  sheet.legend.push_back({"of cut", colour::grey, Dash::solid});
  sheet.legend.push_back({"of ideal", colour::grey, Dash::dashed});
  figures.push_back(figure_of("regions", sheet));
}

}  // namespace aureole
