// Auras by motion first, then by the blows that these foretell.
#include "server/aura/adaptive/outlook.h"

#include <algorithm>

#include "server/aura/adaptive/aura_size.h"

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
AuraCapsule Outlook::own_aura(const HostedBody& body) const {
  return lies_still(body) ? resting_aura(body) : flight_aura(body, reach_s_);
}

void Outlook::look(const MigrationSituation& s) {
  auras_.clear();
  boxes_.clear();
  moving_mps_.clear();
  for (const HostedBody& body : s.hosted) {
    // What has just stopped may start again: it counts as moving, if only a little.
    moving_mps_.push_back(lies_still(body) ? -1.0
                                           : std::max(body.motion_speed_mps, still_speed_mps));
    auras_.push_back(own_aura(body));
    // A deed starts at once, and in any direction; so does what geometry turns.
    if (const double sudden = sudden_mps(body); sudden > 0)
      auras_.back() = struck_aura(auras_.back(), sudden * reach_s_, reach_s_);
    boxes_.push_back(auras_.back().box());
  }
  grid_.build(boxes_);
  blows_.compute(s, {moving_mps_, auras_, boxes_, grid_}, forecast_);
  bool grown = false;
  for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
    if (forecast_.way_m[i] <= sudden_mps(s.hosted[i]) * reach_s_) continue;
    auras_[i] = struck_aura(own_aura(s.hosted[i]), forecast_.way_m[i], reach_s_);
    boxes_[i] = auras_[i].box();
    grown = true;
  }
  if (grown) grid_.build(boxes_);
  remote_boxes_.clear();
  for (const RemoteAura& aura : s.remote) {
    remote_boxes_.push_back(aura.room.box());
    const AuraBox& box = remote_boxes_.back();
    around_others_ = remote_boxes_.size() == 1 ? box : joined(around_others_, box);
  }
  remote_grid_.build(remote_boxes_);
}

void Outlook::find_company(std::uint32_t body, double clearance_m,
                           std::vector<std::uint32_t>& found) const {
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  AuraBox box = boxes_[body];
  box.half.array() += clearance_m;
  grid_.find(box, found);
  const auto needs_no_company = [&](std::uint32_t other) {
    return (rests(body) && rests(other)) || gap_m(auras_[body], auras_[other]) > clearance_m;
  };
  found.erase(std::remove_if(found.begin() + before, found.end(), needs_no_company), found.end());
}

}  // namespace aureole
