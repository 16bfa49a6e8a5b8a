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
  explicit Outlook(double reach_s) : reach_s_(reach_s), blows_(reach_s) {}

  /// From the next look on.
  void set_reach(double reach_s) {
    reach_s_ = reach_s;
    blows_ = BlowForecast(reach_s);
  }
  void look(const MigrationSituation& situation);

  /// Whether the body lies still and expects no blow.
  bool rests(std::uint32_t body) const { return forecast_.expected_mps[body] <= 0; }
  /// Whether it moves by itself, blows apart.
  bool moves(std::uint32_t body) const { return moving_mps_[body] > 0; }
  /// The fastest that it may soon move (m/s).
  double expected_mps(std::uint32_t body) const { return forecast_.expected_mps[body]; }
  const AuraCapsule& aura(std::uint32_t body) const { return auras_[body]; }
  /// The box around it.
  const AuraBox& box(std::uint32_t body) const { return boxes_[body]; }

  /// Appends whose auras come within `clearance_m` of the body's, except where both rest: who must
  /// be hosted with it. The body itself may be among them.
  void find_company(std::uint32_t body, double clearance_m,
                    std::vector<std::uint32_t>& found) const;

  /// Boxes around all auras of hosted bodies.
  const OverlapGrid& grid() const { return grid_; }
  /// Boxes around all auras of others.
  const OverlapGrid& remote_grid() const { return remote_grid_; }
  /// Whether a box is anywhere near an aura of others.
  bool near_others(const AuraBox& box) const {
    return !remote_boxes_.empty() && around_others_.overlaps(box);
  }

 private:
  AuraCapsule own_aura(const HostedBody& body) const;

  double reach_s_;
  std::vector<AuraCapsule> auras_;
  std::vector<AuraBox> boxes_, remote_boxes_;
  std::vector<double> moving_mps_;  ///< Of each body by itself; negative: it lies still.
  OverlapGrid grid_, remote_grid_;
  AuraBox around_others_;
  BlowForecast blows_;
  Forecast forecast_;
};

}  // namespace aureole
