// Who may soon be struck, directly or through what they touch, and how fast it may make them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/overlap_grid.h"

namespace aureole {

/// Slower blows than this are not passed on (m/s): what a stand-in takes without harm.
inline constexpr double blow_speed_min_mps = 0.025;

/// What moves a body that is struck, and through it the next ones.
struct Blow {
  double momentum_kgmps = 0;  ///< What there is to share.
  double moving_kg = 0;       ///< Mass of everything on the way here that it moves along.
  double after_s = 0;         ///< It comes no sooner than this.

  /// The fastest that it can make a body: momentum over the mass of all that moves together, and
  /// (1 + e) times that if it bounces off.
  double speed_mps(double struck_kg, double restitution) const {
    return (1 + restitution) * momentum_kgmps / (moving_kg + struck_kg);
  }
};

/// What may become of each body, by its index in `hosted`.
struct Forecast {
  /// The fastest that each may soon move, by itself or because of a blow (m/s); 0 for what rests
  /// and will not be struck.
  std::vector<double> expected_mps;
  /// How far it may get in whatever direction within the reach time, apart from where it is going
  /// (m): its speed for as long as there is left after a blow that it takes or deals.
  std::vector<double> way_m;
};

/// Who may soon be struck.
///
/// A blow begins where an aura of something that moves, ours or another server's, meets a body.
/// From there it goes through contacts, as an impulse does: a ball into a row of ten moves all ten
/// within five steps. Along a row nothing is lost, but all that is pushed shares the momentum;
/// where a body touches several others, each gets its share (twice an even one: force chains are
/// uneven), so that a ball on a heap moves what is near it and not the whole heap. And it goes over
/// gaps: a body that is struck may strike, by itself, what it reaches in the time that counts.
class BlowForecast {
 public:
  explicit BlowForecast(double reach_s) : reach_s_(reach_s) {}

  /// What bodies do by themselves, by their index in `hosted`.
  struct Motion {
    std::span<const double> moving_mps;  ///< Each body's own speed, negative for one that rests.
    std::span<const AuraCapsule> auras;
    std::span<const AuraBox> boxes;  ///< Around the auras, in `grid`.
    const OverlapGrid& grid;
  };
  void compute(const MigrationSituation& situation, const Motion& motion, Forecast& forecast);

 private:
  void strike(const HostedBody& struck, std::uint32_t index, const Blow& blow, double restitution);
  void disturb(std::uint32_t index, double speed_mps, double after_s);
  void pass_on(const MigrationSituation& situation, const OverlapGrid& grid);
  void look_around(const MigrationSituation& situation, const OverlapGrid& grid, std::uint32_t from,
                   double flight_m);

  double reach_s_;
  Forecast* forecast_ = nullptr;      ///< Within compute().
  std::vector<Blow> blows_;           ///< The hardest that each body may take.
  std::vector<std::uint32_t> front_;  ///< Bodies whose blow has not been passed on yet.
  std::vector<char> waits_;           ///< Whether it is in what is left of the front.
  std::vector<std::uint32_t> found_;
  std::vector<std::uint32_t> touched_, near_;  ///< Of the body in work.
  std::size_t leaning_on_ = 0;                 ///< Its contacts, with others' bodies too.
};

}  // namespace aureole
