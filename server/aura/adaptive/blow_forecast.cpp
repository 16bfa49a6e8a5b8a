// Blows from what moves, through contacts, until they are too weak to matter.
#include "server/aura/adaptive/blow_forecast.h"

#include <algorithm>

namespace aureole {
namespace {

/// How much more than an even share one of several contacts may pass on.
constexpr double unevenness = 2.0;

/// Bullet finds no contact of two spheres with the least gap between them: so near they touch (m).
constexpr double spheres_touch_m = 0.005;
/// Other contacts exist before the shapes touch, this far apart (m): Bullet's breaking threshold.
constexpr double contact_margin_m = 0.02;

double gap_of_spheres(const HostedBody& a, const HostedBody& b) {
  return distance(a.position, b.position) - a.bounding_radius_m - b.bounding_radius_m;
}

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
      if (striking.deed_speed_mps > 0)
        strike(struck, other,
               {striking.deed_mass_kg * striking.deed_speed_mps, striking.deed_mass_kg},
               striking.restitution * struck.restitution, expected_mps);
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
  if (s.contacts != nullptr) pass_on(s, grid, expected_mps);
}

/// Sorts what is around a struck body into what it touches and what it may fly into.
void BlowForecast::look_around(const MigrationSituation& s, const OverlapGrid& grid,
                               std::uint32_t from, double speed_mps) {
  const HostedBody& body = s.hosted[from];
  touched_ids_.clear();
  touched_.clear();
  near_.clear();
  s.contacts->touching(body.id, touched_ids_);
  leaning_on_ = touched_ids_.size();
  for (BodyId id : touched_ids_)
    if (const auto index = index_of(s.hosted, id)) touched_.push_back(*index);
  const double flight_m = speed_mps * reach_s_;
  const bool flies = flight_m > contact_margin_m;
  if (!body.round && !flies) return;
  AuraBox reach{body.position.vector(), body.half_extents};
  reach.half.array() += std::max(flight_m, spheres_touch_m);
  found_.clear();
  grid.find(reach, found_);
  for (std::uint32_t other : found_) {
    if (other == from || std::find(touched_.begin(), touched_.end(), other) != touched_.end())
      continue;
    const HostedBody& next = s.hosted[other];
    if (body.round && next.round) {
      const double gap = gap_of_spheres(body, next);
      if (gap < spheres_touch_m) {
        touched_.push_back(other);
        ++leaning_on_;
      } else if (gap < flight_m) {
        near_.push_back(other);
      }
    } else if (flies && reach.overlaps({next.position.vector(), next.half_extents})) {
      near_.push_back(other);
    }
  }
}

void BlowForecast::pass_on(const MigrationSituation& s, const OverlapGrid& grid,
                           std::vector<double>& expected_mps) {
  for (std::size_t k = 0; k < front_.size(); ++k) {
    const std::uint32_t from = front_[k];
    const HostedBody& body = s.hosted[from];
    look_around(s, grid, from, expected_mps[from]);
    // One of them is where the blow came from. Those of other servers count too: their owners hear
    // of our aura.
    const auto onward = static_cast<double>(std::max<std::size_t>(leaning_on_, 2) - 1);
    Blow share = blows_[from];
    share.momentum_kgmps *= std::min(1.0, unevenness / onward);
    for (std::uint32_t to : touched_)
      strike(s.hosted[to], to, share, body.restitution * s.hosted[to].restitution, expected_mps);
    const Blow alone{body.mass_kg * expected_mps[from], body.mass_kg};
    for (std::uint32_t to : near_)
      strike(s.hosted[to], to, alone, body.restitution * s.hosted[to].restitution, expected_mps);
  }
}

}  // namespace aureole
