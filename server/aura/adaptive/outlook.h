// What may become of each hosted body before anybody could act on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/adaptive/blow_forecast.h"
#include "server/aura/migration_policy.h"
#include "server/aura/overlap_grid.h"

namespace aureole {

/// The auras of one tick: of the bodies hosted here, sized by what each can do and by the blows
/// that it may take, and of those that others project. Bodies are named by their index in
/// `MigrationSituation::hosted`, remote ones by theirs in `remote`.
class Outlook {
 public:
  /// \param reach_s  reach_time_s() of the world's tolerances
  explicit Outlook(double reach_s) : reach_s_(reach_s), forecast_(reach_s) {}

  /// From the next look on.
  void set_reach(double reach_s) {
    reach_s_ = reach_s;
    forecast_ = BlowForecast(reach_s);
  }
  void look(const MigrationSituation& situation);

  /// Whether the body lies still and expects no blow.
  bool rests(std::uint32_t body) const { return expected_mps_[body] <= 0; }
  /// Whether it moves by itself, blows apart.
  bool moves(std::uint32_t body) const { return moving_mps_[body] > 0; }
  /// The fastest that it may soon move (m/s).
  double expected_mps(std::uint32_t body) const { return expected_mps_[body]; }
  const AuraBox& aura(std::uint32_t body) const { return auras_[body]; }

  /// All auras of hosted bodies.
  const OverlapGrid& grid() const { return grid_; }
  /// All auras of others.
  const OverlapGrid& remote_grid() const { return remote_grid_; }

 private:
  AuraBox own_aura(const HostedBody& body) const;

  double reach_s_;
  std::vector<AuraBox> auras_, remote_auras_;
  std::vector<double> moving_mps_;    ///< Of each body by itself; negative: it lies still.
  std::vector<bool> disturbed_;       ///< Meets something on its way.
  std::vector<double> expected_mps_;  ///< With the blows that it may take; 0: it rests.
  OverlapGrid grid_, remote_grid_;
  BlowForecast forecast_;
};

}  // namespace aureole
