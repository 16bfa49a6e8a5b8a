// Who may soon be struck, directly or through what they touch, and how fast it may make them.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "server/aura/adaptive/outlook/stage.h"
#include "server/aura/migration_policy.h"

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

/// What may become of each body, by its number on the stage. Whoever came later rests and will not
/// be struck.
class Forecast {
 public:
  void clear() { fates_.clear(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(fates_.size()); }
  /// The fastest that each may soon move, by itself or because of a blow (m/s); 0 for what rests
  /// and will not be struck.
  double expected(std::uint32_t number) const {
    return number < fates_.size() ? fates_[number].expected_mps : 0.0;
  }
  /// How far it may get in whatever direction within the reach time, apart from where it is going
  /// (m): its speed for as long as there is left after a blow that it takes or deals.
  double way(std::uint32_t number) const {
    return number < fates_.size() ? fates_[number].way_m : 0.0;
  }
  /// The fastest that a blow may make it, apart from its own motion (m/s).
  double struck(std::uint32_t number) const {
    return number < fates_.size() ? fates_[number].struck_mps : 0.0;
  }
  /// Until then nothing strikes it, nor does it strike anything (s).
  double left_alone_s(std::uint32_t number) const {
    return number < fates_.size() ? fates_[number].left_alone_s
                                  : std::numeric_limits<double>::infinity();
  }

 private:
  friend class BlowForecast;
  struct Fate {
    double expected_mps = 0, way_m = 0;
    double struck_mps = 0;
    double left_alone_s = std::numeric_limits<double>::infinity();
    Blow blow;           ///< The hardest that it may take.
    bool waits = false;  ///< To have it passed on.
  };
  /// Valid until it is asked for somebody else.
  Fate& of(std::uint32_t number) {
    if (fates_.size() <= number) fates_.resize(number + 1);
    return fates_[number];
  }
  std::vector<Fate> fates_;
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

  /// `moving_mps`: each one's own speed, negative for one that rests, of the first on the stage;
  /// the others rest. `remote_rows`: boxes around all of `MigrationSituation::remote`.
  void compute(const MigrationSituation& situation, Stage& stage,
               std::span<const double> moving_mps, const BoxRows& remote_rows, Forecast& forecast);

 private:
  void strike(std::uint32_t struck, const Blow& blow, double restitution);
  void disturb(std::uint32_t number, double speed_mps, double after_s);
  bool is_known(std::uint32_t number, const Blow& blow, double restitution) const;
  bool meets_others(std::uint32_t number, const BoxRows& remote_rows);
  void pass_on();
  void look_around(std::uint32_t from, double flight_m);

  double reach_s_;
  Forecast* forecast_ = nullptr;  ///< Within compute().
  Stage* stage_ = nullptr;
  std::span<const RemoteAura> remote_;
  std::vector<std::uint32_t> front_;  ///< Bodies whose blow has not been passed on yet.
  std::vector<std::uint32_t> found_;
  std::vector<std::uint32_t> touched_, near_;  ///< Of the body in work.
  std::size_t leaning_on_ = 0;                 ///< Its contacts, with others' bodies too.
};

}  // namespace aureole
