// Who is told of an aura: of what is at home those whom it reaches, of what is abroad all around.
#include <algorithm>
#include <random>

#include "server/aura/audience.h"
#include "server/aura/partition/partition_lines.h"
#include "server/aura/shapes/aura_box.h"
#include "tests/support/catch.h"
#include "tests/unit/aura/aura_maps.h"

using namespace aureole;
using namespace aureole::aura_maps;

namespace {

PartitionMap columns() {
  return PartitionMap(
      {{-inf, -inf, 10, inf}, {10, -inf, 20, inf}, {20, -inf, 30, inf}, {30, -inf, inf, inf}});
}

/// As the adaptive mode asks: three times half the larger edge.
RegionSet told_of(const PartitionMap& map, RegionId home, const AuraBox& box) {
  if (map.area(home).holds(footprint(box))) return {};
  return audience_at_home(map, home, WorldPosition::from(box.centre),
                          3 * std::max(box.half.x(), box.half.z()));
}

}  // namespace

TEST_CASE("what lies at home beside a boundary is told to the other side alone") {
  REQUIRE(audience_at_home(quarters(), r(0), {-1, 0, -40}, 3).regions() == regions({1}));
  REQUIRE(audience_at_home(columns(), r(1), {19, 0, 5}, 3).regions() == regions({2}));
  REQUIRE(audience_at_home(columns(), r(1), {15, 0, 5}, 3).empty());
}

TEST_CASE("what lies at home at a corner is told to all who meet there") {
  REQUIRE(audience_at_home(quarters(), r(0), {-1, 0, -1}, 3).regions() == regions({1, 2, 3}));
  REQUIRE(audience_at_home(t_shape(), r(0), {-1, 0, -1}, 3).regions() == regions({1, 2}));
}

TEST_CASE("what reaches from home further than the neighbours is told to everybody") {
  REQUIRE(audience_at_home(columns(), r(0), {9, 0, 0}, 11.5).regions() == regions({1, 2, 3}));
}

TEST_CASE("what lies abroad is told to all who may have something there") {
  REQUIRE(audience_of(quarters(), r(0), {5, 0, -40}, 1).regions() == regions({1, 2, 3}));
  REQUIRE(audience_of(columns(), r(1), {25, 0, 0}, 1).regions() == regions({2, 3}));
}

TEST_CASE("of two auras at home that overlap one side hears, also if they meet in a third region") {
  std::mt19937 dice(7);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(dice);
  };
  int met = 0, met_in_a_third = 0, unheard = 0;
  for (const PartitionMap& map : {quarters(), t_shape(), columns()}) {
    for (int i = 0; i < 200'000; ++i) {
      const double size_m = std::exp(between(-1, 2.5));
      const auto any_box = [&] {
        const double half = between(0.05, 1) * size_m;
        return AuraBox{{between(-2, 2) * size_m + between(0, 20), 0, between(-2, 2) * size_m},
                       {half * between(0.1, 1), 1, half * between(0.1, 1)}};
      };
      const AuraBox a = any_box(), b = any_box();
      const RegionId home_a = map.region_at(a.centre.x(), a.centre.z());
      const RegionId home_b = map.region_at(b.centre.x(), b.centre.z());
      if (home_a == home_b || !a.overlaps(b)) continue;
      ++met;
      const double x = (std::max(a.centre.x() - a.half.x(), b.centre.x() - b.half.x()) +
                        std::min(a.centre.x() + a.half.x(), b.centre.x() + b.half.x())) /
                       2;
      const double z = (std::max(a.centre.z() - a.half.z(), b.centre.z() - b.half.z()) +
                        std::min(a.centre.z() + a.half.z(), b.centre.z() + b.half.z())) /
                       2;
      const RegionId there = map.region_at(x, z);
      met_in_a_third += there != home_a && there != home_b;
      unheard +=
          !told_of(map, home_a, a).contains(home_b) && !told_of(map, home_b, b).contains(home_a);
    }
  }
  REQUIRE(met > 2'000);
  REQUIRE(met_in_a_third > 10);
  REQUIRE(unheard == 0);
}

TEST_CASE("of two servers that disagree where they end, one that knows it tells the other") {
  std::mt19937 dice(11);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(dice);
  };
  int met = 0, between_lines = 0, unheard = 0;
  for (const PartitionMap& map : {quarters(), t_shape()}) {
    const PartitionLines lines(map);
    const double margin_m = 2 * lines.longest_shift_m();
    const auto map_of_somebody = [&] {
      std::vector<double> loads;
      for (std::size_t k = 0; k < map.size(); ++k) loads.push_back(between(900, 1100));
      return PartitionMap(lines.areas(lines.shifts_m(loads)));
    };
    // As the adaptive mode asks where three regions meet.
    const auto told = [](const PartitionMap& by, RegionId host, const AuraBox& box, double margin) {
      if (Rectangle(by.area(host)).inner(margin).holds(footprint(box))) return RegionSet{};
      const double reach_m = std::max(box.half.x(), box.half.z());
      return audience_of(by, host, WorldPosition::from(box.centre), 1.5 * reach_m + margin);
    };
    for (int i = 0; i < 100'000; ++i) {
      const PartitionMap up_to_date = map_of_somebody(), behind = map_of_somebody();
      const AuraBox a{{between(-20, 20), 0, between(-20, 20)}, {between(0.1, 3), 1, 1}};
      const AuraBox b{{a.centre.x() + between(-3, 3), 0, a.centre.z()}, {between(0.1, 3), 1, 1}};
      if (!a.overlaps(b)) continue;
      // Each is at home by the map of its server.
      const RegionId host_a = up_to_date.region_at(a.centre.x(), a.centre.z());
      const RegionId host_b = behind.region_at(b.centre.x(), b.centre.z());
      if (host_a == host_b) continue;
      ++met;
      const bool a_is_told = told(up_to_date, host_a, a, 0).contains(host_b);
      between_lines += !a_is_told && !told(behind, host_b, b, 0).contains(host_a);
      unheard += !a_is_told && !told(behind, host_b, b, margin_m).contains(host_a);
    }
  }
  REQUIRE(met > 2'000);
  REQUIRE(between_lines > 100);
  REQUIRE(unheard == 0);
}
