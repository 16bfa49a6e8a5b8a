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

}  // namespace

AuraBox Outlook::own_aura(const HostedBody& body) const {
  if (lies_still(body)) return resting_aura(body);
  if (body.deed_speed_mps <= 0) return flight_aura(body, reach_s_);
  return struck_aura(body, std::max(body.surface_speed_mps, body.deed_speed_mps), reach_s_);
}

void Outlook::look(const MigrationSituation& s) {
  auras_.clear();
  moving_mps_.clear();
  for (const HostedBody& body : s.hosted) {
    // What has just stopped may start again: it counts as moving, if only a little.
    moving_mps_.push_back(lies_still(body) ? -1.0
                                           : std::max(body.surface_speed_mps, still_speed_mps));
    auras_.push_back(own_aura(body));
  }
  grid_.build(auras_);
  forecast_.compute(s, moving_mps_, auras_, grid_, expected_mps_, disturbed_);
  bool grown = false;
  for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
    const HostedBody& body = s.hosted[i];
    if (body.deed_speed_mps > 0) disturbed_[i] = true;
    if (rests(i) || (!disturbed_[i] && !body.near_geometry && expected_mps_[i] <= moving_mps_[i]))
      continue;
    auras_[i] = struck_aura(body, std::max(expected_mps_[i], body.deed_speed_mps), reach_s_);
    grown = true;
  }
  if (grown) grid_.build(auras_);
  remote_auras_.clear();
  for (const RemoteAura& aura : s.remote) remote_auras_.push_back(aura.box);
  remote_grid_.build(remote_auras_);
}

}  // namespace aureole
