// Who may soon be struck, directly or through what they touch, and how fast it may make them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/overlap_grid.h"

namespace aureole {

/// Slower blows than this are not passed on (m/s): what a stand-in takes without harm.
inline constexpr double blow_speed_min_mps = 0.1;

/// How fast a body of mass `struck_kg` may become when one of `striking_kg` meets it at `speed_mps`:
/// a central collision of two free bodies, v (1 + e) m / (m + M), with some room for those that
/// turn and for blows from two sides at once.
double passed_on_mps(double speed_mps, double striking_kg, double struck_kg, double restitution);

/// Fills `expected_mps` (by index in `hosted`): the fastest that each body may soon move, by itself
/// or because of a blow; 0 for what rests and will not be struck.
///
/// A blow begins where an aura of something that moves, ours or another server's, meets a body. From
/// there it goes through contacts, as an impulse does: a ball into a row of ten moves all ten within
/// five steps. Each contact passes on only a part, so that a heap does not move for ever.
class BlowForecast {
 public:
  /// `boxes` are the auras of `hosted` by their own motion, in `grid`. `moving_mps` is each body's
  /// own speed, negative for one that rests. `disturbed`: whether the body meets anything on its way,
  /// ours or another server's, so that it may go on in any direction.
  void compute(const MigrationSituation& situation, std::span<const double> moving_mps,
               std::span<const AuraBox> boxes, const OverlapGrid& grid,
               std::vector<double>& expected_mps, std::vector<bool>& disturbed);

 private:
  void strike(std::uint32_t body, double speed_mps, std::vector<double>& expected_mps);

  std::vector<std::uint32_t> front_;  ///< Bodies whose blow has not been passed on yet.
  std::vector<std::uint32_t> found_;
  std::vector<BodyId> touched_;
};

}  // namespace aureole
