// What may become of each hosted body before anybody could act on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/adaptive/outlook/blow_forecast.h"
#include "server/aura/adaptive/outlook/stage.h"
#include "server/aura/migration_policy.h"
#include "server/aura/shapes/box_rows.h"

namespace aureole {

/// The auras of one tick: of the bodies hosted here, sized by what each can do and by the blows
/// that it may take, and of those that others project. Bodies are named by their numbers on the
/// stage, remote ones by their index in `MigrationSituation::remote`.
class Outlook {
 public:
  /// \param reach_s  reach_time_s() of the world's tolerances
  explicit Outlook(double reach_s) : reach_s_(reach_s), slow_reach_s_(reach_s), blows_(reach_s) {}

  /// From the next look on.
  void set_reach(double reach_s) { reach_s_ = reach_s; }
  void look(const MigrationSituation& situation);

  /// Who is on the stage.
  Stage& stage() { return stage_; }
  std::uint32_t size() const { return stage_.size(); }
  const HostedBody& body(std::uint32_t number) const { return stage_.body(number); }
  const AuraCapsule& aura(std::uint32_t number) const { return stage_.aura(number); }
  /// The box around it.
  const AuraBox& box(std::uint32_t number) const { return stage_.box(number); }
  /// See Stage::find().
  void find(const AuraBox& box, std::vector<std::uint32_t>& found) { stage_.find(box, found); }

  /// Whether the body lies still and expects no blow.
  bool rests(std::uint32_t number) const { return expected_mps(number) <= 0; }
  /// Whether it moves by itself, blows apart.
  bool moves(std::uint32_t number) const {
    return number < moving_mps_.size() && moving_mps_[number] > 0;
  }
  /// The fastest that it may soon move (m/s).
  double expected_mps(std::uint32_t number) const { return forecast_.expected(number); }

  /// Whether two must be hosted together: their auras overlap, and not both rest.
  bool are_company(std::uint32_t a, std::uint32_t b) const {
    return !(rests(a) && rests(b)) && overlap(aura(a), aura(b));
  }

  /// Boxes around all auras of others, by index.
  std::span<const AuraBox> remote_boxes() const { return remote_boxes_; }
  const BoxRows& remote_rows() const { return remote_rows_; }
  /// Whether a box is anywhere near an aura of others.
  bool near_others(const AuraBox& box) const {
    return !remote_boxes_.empty() && around_others_.overlaps(box);
  }

 private:
  AuraCapsule own_aura(const HostedBody& body, double duration_s) const;
  AuraCapsule struck(std::uint32_t number) const;
  void look_at_others(std::span<const RemoteAura> remote);

  double reach_s_;
  double slow_reach_s_;  ///< Of what is slow, and for blows; as of the last look (spare_from_mps).
  Stage stage_;
  std::vector<AuraCapsule> own_auras_;  ///< Of each of `hosted`, if it is left alone.
  std::vector<AuraBox> remote_boxes_;
  std::vector<double> moving_mps_;  ///< Of each of `hosted` by itself; negative: it lies still.
  BoxRows remote_rows_;
  AuraBox around_others_;
  BlowForecast blows_;
  Forecast forecast_;
};

}  // namespace aureole
