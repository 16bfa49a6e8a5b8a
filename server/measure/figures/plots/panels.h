// Small panels with axes, curves, bars and direct labels, as a script for gnuplot.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace aureole {

/// Stands in the SVG until draw() puts a list of fonts in its place.
inline constexpr const char* figure_font = "FigureSans";

/// Okabe and Ito's palette, told apart by all kinds of colour vision.
/// Source: https://jfly.uni-koeln.de/color/
namespace colour {
inline constexpr const char* blue = "#0072b2";
inline constexpr const char* vermilion = "#d55e00";
inline constexpr const char* green = "#009e73";
inline constexpr const char* sky = "#56b4e9";
inline constexpr const char* orange = "#e69f00";
inline constexpr const char* purple = "#cc79a7";
inline constexpr const char* grey = "#8c8c8c";
inline constexpr const char* text = "#222222";
inline constexpr const char* quiet = "#666666";
}  // namespace colour

/// `step` of `steps` from dark blue to light yellow-green, for what has an order.
std::string ordered_colour(std::size_t step, std::size_t steps);

struct AxisTick {
  double at = 0;
  std::string text;
};

struct Scale {
  std::string label;
  double from = 0, to = 1;
  bool logarithmic = false;
  std::vector<AxisTick> ticks;
  bool named = true;  ///< Whether label and ticks' texts are written.
};
/// From 0 to at least `largest`, at round numbers; at most 11 ticks, whatever `largest` is.
Scale linear_scale(std::string label, double largest);
/// `smallest` and `largest` are above 0; ticks at 1, 2 and 5, or only at 1 if there are many:
/// at most 13, whatever they are.
Scale log_scale(std::string label, double smallest, double largest);

using Points = std::vector<std::pair<double, double>>;

enum class Dash { solid, dashed, thin };
/// Shapes, so that curves are told apart where they lie on each other and without colours.
enum class PointMark { none, circle, triangle, square };

struct Curve {
  Points points;
  std::string colour;
  Dash dash = Dash::solid;
  PointMark mark = PointMark::none;  ///< At each point.
  std::string label;                 ///< Beside its last point.
  double width = 2;
};

/// A filled rectangle in the panel's units.
struct Bar {
  double left = 0, right = 0, bottom = 0, top = 0;
  std::string colour;
};

/// A thin horizontal line; its name stands to the right of the panel.
struct Rule {
  double at = 0;
  std::string label;
};

struct Panel {
  double left = 0, top = 0, width = 0, height = 0;  ///< Of the area that is plotted in (px).
  std::string title;
  Scale x, y;
  std::vector<Curve> curves;
  std::vector<Bar> bars;
  std::vector<Rule> rules;
};

struct Legend {
  std::string label, colour;
  Dash dash = Dash::solid;
  bool filled = false;  ///< A square instead of a line.
  PointMark mark = PointMark::none;
};

/// A whole picture.
struct Sheet {
  int width = 900, height = 420;  ///< px
  std::string title, subtitle;
  std::vector<Legend> legend;  ///< In one row below the subtitle.
  std::vector<Panel> panels;
};

std::string script_of(const Sheet& sheet);

/// Moves what lies closer than `gap` apart, as little as possible. Same order as given.
std::vector<double> spread(const std::vector<double>& at, double gap);

}  // namespace aureole
