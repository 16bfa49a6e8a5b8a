// Blows from what moves, through contacts, until they are too weak to matter.
#include "server/aura/blow_forecast.h"

#include <algorithm>

namespace aureole {
namespace {

/// How much more than an even share one of several contacts may pass on.
constexpr double unevenness = 2.0;

}  // namespace

void BlowForecast::strike(const HostedBody& struck, std::uint32_t index, const Blow& blow,
                          double restitution, std::vector<double>& expected_mps) {
  const double speed_mps = blow.speed_mps(struck.mass_kg, restitution);
  if (speed_mps < blow_speed_min_mps || speed_mps <= expected_mps[index]) return;
  expected_mps[index] = speed_mps;
  blows_[index] = {blow.momentum_kgmps, blow.moving_kg + struck.mass_kg};
  front_.push_back(index);
}

void BlowForecast::compute(const MigrationSituation& s, std::span<const double> moving_mps,
                           std::span<const AuraBox> boxes, const OverlapGrid& grid,
                           std::vector<double>& expected_mps, std::vector<bool>& disturbed) {
  const auto count = static_cast<std::uint32_t>(s.hosted.size());
  expected_mps.assign(count, 0.0);
  disturbed.assign(count, false);
  blows_.assign(count, {});
  front_.clear();
  for (std::uint32_t i = 0; i < count; ++i) expected_mps[i] = std::max(moving_mps[i], 0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (moving_mps[i] < 0) continue;
    found_.clear();
    grid.find(boxes[i], found_);
    for (std::uint32_t other : found_) {
      if (other == i) continue;
      disturbed[i] = disturbed[other] = true;
      const double closing = moving_mps[i] + std::max(moving_mps[other], 0.0);
      const HostedBody &striking = s.hosted[i], &struck = s.hosted[other];
      strike(struck, other, {striking.mass_kg * closing, striking.mass_kg},
             striking.restitution * struck.restitution, expected_mps);
    }
  }
  for (const RemoteAura& aura : s.remote) {
    found_.clear();
    grid.find(aura.box, found_);
    for (std::uint32_t other : found_) {
      const HostedBody& struck = s.hosted[other];
      if (struck.id == aura.id) continue;
      disturbed[other] = true;
      const double closing = aura.speed_mps + std::max(moving_mps[other], 0.0);
      if (!aura.resting)
        strike(struck, other, {aura.mass_kg * closing, aura.mass_kg}, struck.restitution,
               expected_mps);
    }
  }
  if (s.contacts != nullptr) pass_on(s, expected_mps);
}

void BlowForecast::pass_on(const MigrationSituation& s, std::vector<double>& expected_mps) {
  for (std::size_t k = 0; k < front_.size(); ++k) {
    const std::uint32_t from = front_[k];
    touched_.clear();
    s.contacts->touching(s.hosted[from].id, touched_);
    // One of them is where the blow came from.
    const auto onward = static_cast<double>(std::max<std::size_t>(touched_.size(), 2) - 1);
    Blow share = blows_[from];
    share.momentum_kgmps *= std::min(1.0, unevenness / onward);
    for (BodyId id : touched_) {
      const auto to = index_of(s.hosted, id);
      if (!to) continue;  // A stand-in: its owner hears of our aura.
      strike(s.hosted[*to], *to, share, s.hosted[from].restitution * s.hosted[*to].restitution,
             expected_mps);
    }
  }
}

}  // namespace aureole
