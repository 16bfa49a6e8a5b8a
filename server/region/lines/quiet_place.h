// Where a line had better lie that two regions meet at, side by side in a row of regions.
#pragma once

#include <limits>

#include "server/region/lines/crowd.h"

namespace aureole {

/// When a line may leave a crowd.
struct QuietPlaceLimits {
  double crowd_min = 8;              ///< Fewer are not worth moving a line for (bodies awake).
  double crowd_share = 0.08;         ///< Not more than this of all that is awake anywhere.
  double load_share_of_mean = 1.15;  ///< What a side may have after a move, of all servers' mean.
  /// For tests of moving lines: for any crowd, whoever then has it until the line goes back.
  static QuietPlaceLimits none() {
    constexpr double any = std::numeric_limits<double>::infinity();
    return {1, any, any};
  }
};

/// The place of a line, and whom it is between.
struct LineSituation {
  double here_m = 0;            ///< Where it lies, from its place in the map.
  double far_m = 0;             ///< As far as it may be moved, to either side.
  Crowd below_has, above_has;   ///< Who is awake there, by the side that hosts it.
  double below = 0, above = 0;  ///< Bodies awake on either side; what other lines give included.
  double mean = 0, all = 0;     ///< Of all servers of the world, and what they have together.
  QuietPlaceLimits limits;

  /// How many bodies awake the side below gets if the line lies there.
  double gain(double place_m) const;
  /// What the side that has more would have then.
  double busier(double place_m) const;
  /// Whoever is so near that it would be about the line if that lay there.
  double stirs_at(double place_m) const { return below_has.at(place_m) + above_has.at(place_m); }
};

/// Where a line had better lie (m, from its place in the map), or where it lies.
///
/// A line that lies in a crowd costs both its servers: what may touch across it has to be told of,
/// decided about and brought together. It is better off where at most half as many stir. But the
/// crowd then belongs to one server, and in a row one server is left without any: so only a crowd
/// of at most 8 % of all that is awake anywhere is given away whole, and only if neither side then
/// has more than 15 % over the mean of all servers. A larger one is shared out where it lies: the
/// line moves inside of it, by at most 12 m, to where the side that has more has least, if that is
/// 2 % of the mean less than now. What meets at the line contests share out (load_balance.h). Who
/// has 30 % too much because of its line is rid of it: the line goes back to its place in the map.
/// Fewer than 8 bodies are not worth the way.
double quiet_place_m(const LineSituation& line);

/// Whether one of the sides would have far too much, 30 % over the mean, if the line lay there.
bool overloads(const LineSituation& line, double place_m);

}  // namespace aureole
