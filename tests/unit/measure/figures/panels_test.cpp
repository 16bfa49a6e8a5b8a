// Scales, places of labels, and text that must mean nothing to gnuplot.
#include "server/measure/figures/plots/panels.h"

#include <cmath>
#include <limits>
#include <set>

#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("a linear scale ends at a round number that is large enough") {
  for (const double largest : {0.003, 0.7, 1.0, 16.0, 99.0, 100.0, 101.0, 12'345.0}) {
    CAPTURE(largest);
    const Scale scale = linear_scale("", largest);
    CHECK(scale.from == 0);
    CHECK(scale.to >= largest * 0.999999);
    CHECK(scale.to <= largest * 2);
    CHECK(scale.ticks.front().at == 0);
    CHECK(scale.ticks.back().at == Approx(scale.to));
    CHECK(scale.ticks.size() >= 3);
    CHECK(scale.ticks.size() <= 6);
  }
  CHECK(linear_scale("", 0).to == 1);
  CHECK(linear_scale("", 100).ticks[1].text == "25");
}

TEST_CASE("no number gives a scale more ticks than can be drawn") {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const double largest : {1.7e308, 9.9e307, 1e15, 1e-15, 1e-300, 5e-324, 0.0, -1.0, infinite,
                               -infinite, std::nan("")}) {
    CAPTURE(largest);
    const Scale linear = linear_scale("", largest);
    CHECK(std::isfinite(linear.to));
    CHECK(linear.to > 0);
    CHECK(linear.ticks.size() >= 2);
    CHECK(linear.ticks.size() <= 11);
    for (const double smallest : {1.7e308, 1e15, 1e-15, 5e-324, 0.0, infinite, std::nan("")}) {
      CAPTURE(smallest);
      const Scale logarithmic = log_scale("", smallest, largest);
      CHECK(logarithmic.from > 0);
      CHECK(logarithmic.to > logarithmic.from);
      CHECK(std::isfinite(logarithmic.to));
      CHECK(logarithmic.ticks.size() <= 13);
    }
  }
}

TEST_CASE("a logarithmic scale has ticks at 1, 2 and 5 of what it covers, and no others") {
  const Scale scale = log_scale("", 0.8, 60);
  std::vector<std::string> texts;
  for (const AxisTick& tick : scale.ticks) texts.push_back(tick.text);
  CHECK(texts == std::vector<std::string>{"1", "2", "5", "10", "20", "50"});
  CHECK(scale.from == 0.8);
  CHECK(scale.to == 60);
}

TEST_CASE("labels that would overlap move apart, in their order and no further than they must") {
  CHECK(spread({10, 50, 100}, 12) == std::vector<double>{10, 50, 100});
  CHECK(spread({50, 10}, 12) == std::vector<double>{50, 10});
  // Two at one place: half of the gap each.
  CHECK(spread({20, 20}, 12) == std::vector<double>{14, 26});
  const auto moved = spread({30, 10, 12, 11, 29}, 10);
  std::multiset<double> sorted(moved.begin(), moved.end());
  double before = -1e9;
  for (const double at : sorted) {
    CHECK(at - before >= 10 - 1e-9);
    before = at;
  }
  CHECK(moved[1] < moved[3]);
  CHECK(moved[3] < moved[2]);
  CHECK(moved[2] < moved[4]);
  CHECK(moved[4] < moved[0]);
  CHECK(spread({}, 10).empty());
}

TEST_CASE("texts cannot leave their quotes or mean anything to gnuplot") {
  Sheet sheet;
  sheet.title = "a\"; system(\"x\") `id` $HOME \\n {/=90 b} c_d";
  sheet.panels.push_back({});
  const std::string script = script_of(sheet);
  const auto from = script.find("a; system(x)");
  REQUIRE(from != std::string::npos);
  const std::string title = script.substr(from, script.find('\n', from) - from);
  CHECK(title.find('`') == std::string::npos);
  CHECK(title.find('$') == std::string::npos);
  CHECK(title.find("\\\\{/=90 b\\\\}") != std::string::npos);
  CHECK(title.find("c\\\\_d") != std::string::npos);
}

TEST_CASE("colours of what has an order are all different") {
  std::set<std::string> colours;
  for (std::size_t i = 0; i < 10; ++i) colours.insert(ordered_colour(i, 10));
  CHECK(colours.size() == 10);
  CHECK(ordered_colour(0, 1) == "#440154");
}
