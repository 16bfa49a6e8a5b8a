// All places are tried. If the crowd may be left the one that fewest are near to is best, unless
// that is unfair; if not the fairest.
#include "server/region/lines/quiet_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aureole {
namespace {

/// What belongs to a line's crowd (m, to either side of its place).
constexpr double crowd_reach_m = 48;
/// A place is quiet where there are at most so many of those who are here.
constexpr double quiet_share = 0.5;
/// What a side has to have of the mean of all servers for the line to go back.
constexpr double overload = 1.3;
/// A metre of the way counts as so many bodies at its end: of two quiet places the nearer one.
constexpr double bodies_per_m = 0.02;

/// A line that stays in its crowd goes no further than this (m), …
constexpr double sharing_reach_m = 12;
/// … and only if the busier side then has so much less, of the mean.
constexpr double worth_moving = 0.02;

/// Of all places up to `far_m` to either side of the line's place in the map the one that costs
/// least, with the way there, if that is less than `least`; else where the line lies.
template <class Cost>
double cheapest_place_m(const LineSituation& line, double far_m, double least, Cost&& cost) {
  double best_m = line.here_m;
  const int reach = static_cast<int>(far_m / Crowd::bin_m);
  for (int i = -reach; i <= reach; ++i) {
    const double place_m = i * Crowd::bin_m;
    const double costs = cost(place_m) + bodies_per_m * std::abs(place_m - line.here_m);
    if (costs >= least) continue;
    least = costs;
    best_m = place_m;
  }
  return best_m;
}

/// Where both sides of a crowd that is shared out have as much to do.
double even_place_m(const LineSituation& line) {
  const double far_m = std::min(sharing_reach_m, line.far_m);
  if (std::abs(line.here_m) > far_m) return line.here_m;
  return cheapest_place_m(line, far_m, line.busier(line.here_m) - worth_moving * line.mean,
                          [&](double place_m) { return line.busier(place_m); });
}

}  // namespace

double LineSituation::gain(double place_m) const {
  return above_has.between(Crowd::from_m, place_m) - below_has.between(place_m, -Crowd::from_m);
}

double LineSituation::busier(double place_m) const {
  const double more = gain(place_m);
  return std::max(below + more, above - more);
}

double quiet_place_m(const LineSituation& line) {
  const double gainer = line.here_m > 0 ? line.below : line.above;
  if (line.here_m != 0 && gainer > overload * line.mean) return 0;
  const double here = line.stirs_at(line.here_m);
  const double crowd = line.below_has.between(-crowd_reach_m, crowd_reach_m) +
                       line.above_has.between(-crowd_reach_m, crowd_reach_m);
  if (here < line.limits.crowd_min) return line.here_m;
  if (crowd > line.limits.crowd_share * line.all) return even_place_m(line);
  return cheapest_place_m(line, line.far_m, quiet_share * here, [&](double place_m) {
    const bool fair = line.busier(place_m) <= line.limits.load_share_of_mean * line.mean;
    return fair ? line.stirs_at(place_m) : std::numeric_limits<double>::infinity();
  });
}

bool overloads(const LineSituation& line, double place_m) {
  return line.busier(place_m) > overload * line.mean;
}

}  // namespace aureole
