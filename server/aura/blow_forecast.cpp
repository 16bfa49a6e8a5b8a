// Blows from what moves, through contacts, until they are too weak to matter.
#include "server/aura/blow_forecast.h"

#include <algorithm>

namespace aureole {
namespace {

/// Two blows at once, and blows off centre, move a body faster than the formula for two has it.
constexpr double several_blows = 1.25;

}  // namespace

double passed_on_mps(double speed_mps, double striking_kg, double struck_kg, double restitution) {
  const double share = (1 + restitution) * striking_kg / (striking_kg + struck_kg);
  return speed_mps * (share < 1 ? std::min(several_blows * share, 1.0) : share);
}

void BlowForecast::strike(std::uint32_t body, double speed_mps,
                          std::vector<double>& expected_mps) {
  if (speed_mps < blow_speed_min_mps || speed_mps <= expected_mps[body]) return;
  expected_mps[body] = speed_mps;
  front_.push_back(body);
}

void BlowForecast::compute(const MigrationSituation& s, std::span<const double> moving_mps,
                           std::span<const AuraBox> boxes, const OverlapGrid& grid,
                           std::vector<double>& expected_mps, std::vector<bool>& disturbed) {
  const auto count = static_cast<std::uint32_t>(s.hosted.size());
  expected_mps.assign(count, 0.0);
  disturbed.assign(count, false);
  front_.clear();
  for (std::uint32_t i = 0; i < count; ++i) expected_mps[i] = std::max(moving_mps[i], 0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (moving_mps[i] < 0) continue;
    found_.clear();
    grid.find(boxes[i], found_);
    for (std::uint32_t other : found_) {
      if (other == i) continue;
      disturbed[i] = disturbed[other] = true;
      const double e = s.hosted[i].restitution * s.hosted[other].restitution;
      const double closing = moving_mps[i] + std::max(moving_mps[other], 0.0);
      strike(other, passed_on_mps(closing, s.hosted[i].mass_kg, s.hosted[other].mass_kg, e),
             expected_mps);
    }
  }
  for (const RemoteAura& aura : s.remote) {
    found_.clear();
    grid.find(aura.box, found_);
    for (std::uint32_t other : found_) {
      if (s.hosted[other].id == aura.id) continue;
      disturbed[other] = true;
      const double closing = aura.speed_mps + std::max(moving_mps[other], 0.0);
      if (!aura.resting)
        strike(other,
               passed_on_mps(closing, aura.mass_kg, s.hosted[other].mass_kg,
                             s.hosted[other].restitution),
               expected_mps);
    }
  }
  if (s.contacts == nullptr) return;
  for (std::size_t k = 0; k < front_.size(); ++k) {
    const std::uint32_t from = front_[k];
    touched_.clear();
    s.contacts->touching(s.hosted[from].id, touched_);
    for (BodyId id : touched_) {
      const auto to = index_of(s.hosted, id);
      if (!to) continue;  // A stand-in: its owner hears of our aura.
      const double e = s.hosted[from].restitution * s.hosted[*to].restitution;
      strike(*to,
             passed_on_mps(expected_mps[from], s.hosted[from].mass_kg, s.hosted[*to].mass_kg, e),
             expected_mps);
    }
  }
}

}  // namespace aureole
