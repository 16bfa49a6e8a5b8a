// Text for gnuplot; places are computed here, so that every label is where it belongs.
#include "server/measure/figures/plots/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace aureole {
namespace {

/// gnuplot's enhanced text gives meaning to some characters; none of ours want it.
std::string quoted(const std::string& text) {
  std::string safe = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '\n' || c == '`' || c == '$') continue;
    if (std::string_view("_^{}@&~").find(c) != std::string_view::npos) safe += "\\\\";
    safe += c;
  }
  return safe + "\"";
}

std::string bold(const std::string& text) {
  std::string safe = quoted(text);
  return "\"{/:Bold " + safe.substr(1, safe.size() - 2) + "}\"";
}

std::string plain(double value) {
  return fmt::format("{:g}", std::abs(value) < 1e-12 ? 0 : value);
}

int line_type(Dash dash) {
  return dash == Dash::dashed ? 12 : 11;
}

int point_type(PointMark mark) {
  return mark == PointMark::circle ? 7 : mark == PointMark::triangle ? 9 : 5;
}

/// About: gnuplot cannot know the viewer's font either.
double text_px(const std::string& text) {
  return 7.1 * static_cast<double>(text.size());
}

/// What is further away from 1 is drawn as this: steps between ticks would be 0 or infinite.
constexpr double smallest_drawn = 1e-300, largest_drawn = 1e300;
constexpr int most_ticks = 11;

class Script {
 public:
  explicit Script(const Sheet& sheet) : sheet_(sheet) {
    add("# Drawn by `aureole experiment figures`; again: gnuplot THIS > picture.svg\n"
        "set encoding utf8\n"
        "set terminal svg size {},{} fixed enhanced font \"{},13\" background \"#ffffff\"\n"
        "set style line 100 lc rgb \"#e4e4e4\" lw 1\n"
        // Custom dashes look the same at every line width.
        "set linetype 11 dt solid\nset linetype 12 dt (7,4)\n"
        "unset key\nset multiplot\n",
        sheet.width, sheet.height, figure_font);
  }

  std::string whole() {
    bool first = true;
    for (const Panel& panel : sheet_.panels) {
      begin(panel);
      if (first) head();
      first = false;
      write(panel);
    }
    add("unset multiplot\n");
    return text_;
  }

 private:
  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    text_ += fmt::format(text, std::forward<Args>(args)...);
  }
  std::string screen(double x_px, double y_px) const {
    return fmt::format("screen {:.5f},{:.5f}", x_px / sheet_.width, 1 - y_px / sheet_.height);
  }
  void label(const std::string& text, const std::string& at, const char* where,
             const std::string& colour) {
    add("set label {} at {} {} tc rgb \"{}\"\n", text, at, where, colour);
  }

  void head() {
    label(bold(sheet_.title), screen(16, 22), "left font \",16\"", colour::text);
    label(quoted(sheet_.subtitle), screen(16, 45), "left font \",12\"", colour::quiet);
    double x = 16;
    for (const Legend& entry : sheet_.legend) {
      constexpr double y = 70;
      if (entry.filled) {
        add("set object rectangle from {} to {} fc rgb \"{}\" fs solid noborder\n",
            screen(x, y + 6), screen(x + 14, y - 6), entry.colour);
      } else {
        add("set arrow from {} to {} nohead lt {} lc rgb \"{}\" lw {}\n", screen(x, y),
            screen(x + 30, y), line_type(entry.dash), entry.colour,
            entry.dash == Dash::thin ? "1" : "2.5");
        if (entry.mark != PointMark::none)
          add("set label \"\" at {} point pt {} ps 0.6 lc rgb \"{}\"\n", screen(x + 15, y),
              point_type(entry.mark), entry.colour);
      }
      const double before = entry.filled ? 20 : 37;
      label(quoted(entry.label), screen(x + before, y), "left font \",12\"", colour::text);
      x += before + text_px(entry.label) + 20;
    }
  }

  void scale(const char* axis, const Scale& scale) {
    add("{} logscale {}\n", scale.logarithmic ? "set" : "unset", axis);
    add("set {}range [{}:{}]\n", axis, plain(scale.from), plain(scale.to));
    add("set {}tics nomirror out scale 0.5 offset 0,{} font \",11\" textcolor rgb \"{}\" (", axis,
        *axis == 'x' ? "0.4" : "0", colour::quiet);
    for (std::size_t i = 0; i < scale.ticks.size(); ++i)
      add("{}{} {}", i > 0 ? ", " : "", scale.named ? quoted(scale.ticks[i].text) : "\"\"",
          plain(scale.ticks[i].at));
    add(")\n");
  }

  void begin(const Panel& panel) {
    add("\nunset label\nunset arrow\nunset object\n"
        "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
        "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
        panel.left / sheet_.width, (panel.left + panel.width) / sheet_.width,
        1 - panel.top / sheet_.height, 1 - (panel.top + panel.height) / sheet_.height);
    add("set border 3 lc rgb \"#999999\" lw 1\nset grid ytics back ls 100\n");
    scale("x", panel.x);
    scale("y", panel.y);
    if (!panel.title.empty())
      label(bold(panel.title), screen(panel.left, panel.top - 14), "left font \",13\"",
            colour::text);
    if (panel.x.named && !panel.x.label.empty())
      label(quoted(panel.x.label),
            screen(panel.left + panel.width / 2, panel.top + panel.height + 38),
            "center font \",12\"", colour::text);
    if (panel.y.named && !panel.y.label.empty())
      label(quoted(panel.y.label), screen(panel.left - 58, panel.top + panel.height / 2),
            "center rotate by 90 font \",12\"", colour::text);
  }

  double y_px(const Panel& panel, double value) const {
    const Scale& y = panel.y;
    const auto part = y.logarithmic ? std::log(value / y.from) / std::log(y.to / y.from)
                                    : (value - y.from) / (y.to - y.from);
    return panel.top + panel.height * (1 - part);
  }
  double x_px(const Panel& panel, double value) const {
    const Scale& x = panel.x;
    const auto part = x.logarithmic ? std::log(value / x.from) / std::log(x.to / x.from)
                                    : (value - x.from) / (x.to - x.from);
    return panel.left + panel.width * part;
  }

  void direct_labels(const Panel& panel) {
    std::vector<const Curve*> named;
    std::vector<double> at;
    for (const Curve& curve : panel.curves)
      if (!curve.label.empty() && !curve.points.empty()) {
        named.push_back(&curve);
        at.push_back(y_px(panel, curve.points.back().second));
      }
    at = spread(at, 12.5);
    for (std::size_t i = 0; i < named.size(); ++i)
      label(bold(named[i]->label), screen(x_px(panel, named[i]->points.back().first) + 7, at[i]),
            "left font \",11\"", named[i]->colour);
  }

  void rules(const Panel& panel) {
    for (const Rule& rule : panel.rules) {
      if (rule.at < panel.y.from || rule.at > panel.y.to) continue;
      const double y = y_px(panel, rule.at), right = panel.left + panel.width;
      add("set arrow from {} to {} nohead {} lt 11 lc rgb \"#444444\" lw 0.8\n",
          screen(panel.left, y), screen(right, y), panel.bars.empty() ? "back" : "front");
      label(quoted(rule.label), screen(right + 5, y), "left font \",11\"", "#444444");
    }
  }

  void write(const Panel& panel) {
    direct_labels(panel);
    rules(panel);
    std::string plots;
    const auto data = [&](const std::string& rows, const std::string& how) {
      add("$d{} << EOD\n{}EOD\n", blocks_, rows);
      plots += fmt::format("{}$d{} {}", plots.empty() ? "plot " : ", \\\n  ", blocks_, how);
      ++blocks_;
    };
    for (const Bar& bar : panel.bars)
      data(fmt::format("{} {} {} {} {} {}\n", plain((bar.left + bar.right) / 2),
                       plain((bar.bottom + bar.top) / 2), plain(bar.left), plain(bar.right),
                       plain(bar.bottom), plain(bar.top)),
           fmt::format("with boxxyerror fs solid noborder lc rgb \"{}\"", bar.colour));
    for (const Curve& curve : panel.curves) {
      std::string rows;
      for (const auto& [x, y] : curve.points) rows += fmt::format("{} {}\n", plain(x), plain(y));
      if (rows.empty()) continue;
      data(rows, fmt::format("with {} lt {} lc rgb \"{}\" lw {}{}",
                             curve.mark != PointMark::none ? "linespoints" : "lines",
                             line_type(curve.dash), curve.colour, plain(curve.width),
                             curve.mark != PointMark::none
                                 ? fmt::format(" pt {} ps 0.5", point_type(curve.mark))
                                 : ""));
    }
    // An empty panel is still drawn, and says so.
    if (plots.empty()) {
      label("\"no data\"", screen(panel.left + panel.width / 2, panel.top + panel.height / 2),
            "center", colour::grey);
      plots = "plot NaN notitle";
    }
    text_ += plots + "\n";
  }

  const Sheet& sheet_;
  std::string text_;
  std::size_t blocks_ = 0;
};

}  // namespace

std::string ordered_colour(std::size_t step, std::size_t steps) {
  // Viridis without its lightest end, which white swallows.
  // Source: Smith and van der Walt, https://bids.github.io/colormap/
  static constexpr std::array<std::array<double, 3>, 6> stops = {
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {94, 190, 80}, {160, 190, 30}}};
  const double at = steps < 2 ? 0
                              : static_cast<double>(step) / static_cast<double>(steps - 1) *
                                    static_cast<double>(stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double part = at - static_cast<double>(low);
  std::array<int, 3> mixed{};
  for (std::size_t i = 0; i < 3; ++i)
    mixed[i] = static_cast<int>(stops[low][i] * (1 - part) + stops[low + 1][i] * part + 0.5);
  return fmt::format("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2]);
}

Scale linear_scale(std::string label, double largest) {
  largest = largest > smallest_drawn ? std::min(largest, largest_drawn) : 1;
  const double rough = largest / 4, power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double nice : {1.0, 2.0, 2.5, 5.0})
    if (nice * power >= rough * 0.999) {
      step = nice * power;
      break;
    }
  const int steps = std::min(static_cast<int>(std::ceil(largest / step - 1e-9)), most_ticks - 1);
  Scale scale{std::move(label), 0, steps * step, false, {}, true};
  for (int i = 0; i <= steps; ++i) scale.ticks.push_back({i * step, fmt::format("{:g}", i * step)});
  return scale;
}

Scale log_scale(std::string label, double smallest, double largest) {
  smallest = smallest > smallest_drawn ? std::min(smallest, largest_drawn) : smallest_drawn;
  largest = std::max(smallest * 1.1, std::min(largest, largest_drawn));
  Scale scale{std::move(label), smallest, largest, true, {}, true};
  const int low = static_cast<int>(std::floor(std::log10(scale.from))),
            high = static_cast<int>(std::ceil(std::log10(scale.to)));
  const int stride = 1 + (high - low) / most_ticks;
  for (int power = low; power <= high; power += stride)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double at = digit * std::pow(10, power);
      if (high - low > 4 && digit > 1) continue;
      if (at < scale.from * 0.999 || at > scale.to * 1.001) continue;
      scale.ticks.push_back({at, fmt::format("{:g}", at)});
    }
  return scale;
}

std::vector<double> spread(const std::vector<double>& at, double gap) {
  std::vector<std::size_t> order(at.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return at[a] < at[b]; });
  // Without the gaps, what must not overlap must not fall: neighbours that do share their mean.
  struct Pool {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < order.size(); ++i) {
    pools.push_back({at[order[i]] - static_cast<double>(i) * gap, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      pools[pools.size() - 2].sum += pools.back().sum;
      pools[pools.size() - 2].count += pools.back().count;
      pools.pop_back();
    }
  }
  std::vector<double> moved(at.size());
  std::size_t i = 0;
  for (const Pool& pool : pools)
    for (std::size_t n = 0; n < pool.count; ++n, ++i)
      moved[order[i]] = pool.mean() + static_cast<double>(i) * gap;
  return moved;
}

std::string script_of(const Sheet& sheet) {
  return Script(sheet).whole();
}

}  // namespace aureole
