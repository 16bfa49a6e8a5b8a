// Auras by motion first, then by the blows that these foretell.
#include "server/aura/adaptive/outlook/outlook.h"

#include <algorithm>
#include <limits>

#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {
namespace {

bool lies_still(const HostedBody& body) {
  return !body.pressed && body.deed_speed_mps <= 0 &&
         (body.asleep || body.still_ticks >= resting_ticks);
}

/// What may start from the body without notice.
double sudden_mps(const HostedBody& body) {
  return std::max(body.deed_speed_mps, body.near_geometry ? body.motion_speed_mps : 0.0);
}

}  // namespace

/// What it can touch if it is left alone.
AuraCapsule Outlook::own_aura(const HostedBody& body, double duration_s) const {
  return lies_still(body) ? resting_aura(body) : flight_aura(body, duration_s);
}

/// What it can touch if it strikes something or is struck. It goes on along its way, and from each
/// blow on aside as fast as that one makes it; or, from the first one on, anywhere, as fast as it
/// was and the hardest one makes it.
AuraCapsule Outlook::struck(std::uint32_t number) const {
  const HostedBody& body = stage_.body(number);
  const double sudden = sudden_mps(body);
  const double reach_s = sudden > 0 ? reach_s_ : slow_reach_s_;
  const AuraCapsule along =
      struck_aura(body, number < own_auras_.size() ? own_auras_[number] : resting_aura(body),
                  forecast_.way(number), reach_s);
  const double alone_s =
      sudden > 0 ? 0.0 : std::clamp(forecast_.left_alone_s(number), 0.0, reach_s);
  const double own_mps = number < moving_mps_.size() ? std::max(moving_mps_[number], 0.0) : 0.0;
  const double fastest_mps = std::max(own_mps, sudden) + forecast_.struck(number);
  const AuraCapsule anywhere =
      struck_aura(body, own_aura(body, alone_s), fastest_mps * (reach_s - alone_s), reach_s);
  return smaller(along, anywhere);
}

void Outlook::look(const MigrationSituation& s) {
  const double spare_s = s.map.has_corners() ? spare_ticks * (tick_us / 1e6) : 0.0;
  if (reach_s_ - spare_s != slow_reach_s_) {
    slow_reach_s_ = reach_s_ - spare_s;
    blows_ = BlowForecast(slow_reach_s_);
  }
  stage_.begin(s);
  moving_mps_.clear();
  own_auras_.clear();
  for (const HostedBody& body : s.hosted) {
    // What has just stopped may start again: it counts as moving, if only a little.
    moving_mps_.push_back(lies_still(body) ? -1.0
                                           : std::max(body.motion_speed_mps, still_speed_mps));
    AuraCapsule aura = own_auras_.emplace_back(
        own_aura(body, body.motion_speed_mps > spare_from_mps ? reach_s_ : slow_reach_s_));
    // A deed starts at once, and in any direction; so does what geometry turns.
    if (const double sudden = sudden_mps(body); sudden > 0)
      aura = struck_aura(body, aura, sudden * reach_s_, reach_s_);
    stage_.add(body, aura);
  }
  stage_.sort_boxes();
  stage_.add_sleepers_beyond();
  look_at_others(s.remote);
  blows_.compute(s, stage_, moving_mps_, remote_rows_, forecast_);
  bool grown = false;
  for (std::uint32_t i = 0; i < forecast_.size(); ++i) {
    const HostedBody& body = stage_.body(i);
    if (forecast_.way(i) <= sudden_mps(body) * reach_s_) continue;
    stage_.set_aura(i, struck(i));
    grown = true;
  }
  if (grown) stage_.sort_boxes();
}

void Outlook::look_at_others(std::span<const RemoteAura> remote) {
  remote_boxes_.clear();
  constexpr double nowhere = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(nowhere), high = -low;
  for (const RemoteAura& aura : remote) {
    const AuraBox& box = remote_boxes_.emplace_back(aura.room.box());
    low = low.cwiseMin(box.centre - box.half);
    high = high.cwiseMax(box.centre + box.half);
  }
  if (!remote.empty()) around_others_ = {0.5 * (low + high), 0.5 * (high - low)};
  remote_rows_.build(remote_boxes_);
}

}  // namespace aureole
