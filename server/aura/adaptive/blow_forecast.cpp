// Blows from what moves, through contacts, until they are too weak to matter.
#include "server/aura/adaptive/blow_forecast.h"

#include <algorithm>
#include <utility>

#include "server/aura/adaptive/aura_size.h"

namespace aureole {
namespace {

/// How much more than an even share one of several contacts may pass on.
constexpr double unevenness = 2.0;

/// Bullet finds no contact of two spheres with the least gap between them: so near they touch (m).
constexpr double spheres_touch_m = 0.005;
/// Other contacts exist before the shapes touch, this far apart (m): Bullet's breaking threshold.
constexpr double contact_margin_m = 0.02;

/// A blow that takes a body further by less than this is as good as the one that it has had (m).
constexpr double further_m = 0.02;

double gap_of_spheres(const HostedBody& a, const HostedBody& b) {
  return distance(a.position, b.position) - a.bounding_radius_m - b.bounding_radius_m;
}

}  // namespace

void BlowForecast::disturb(std::uint32_t index, double speed_mps, double after_s) {
  double& way_m = forecast_->way_m[index];
  way_m = std::max(way_m, speed_mps * std::max(0.0, reach_s_ - after_s));
}

void BlowForecast::strike(const HostedBody& struck, std::uint32_t index, const Blow& blow,
                          double restitution) {
  const double speed_mps = blow.speed_mps(struck.mass_kg, restitution);
  if (speed_mps < blow_speed_min_mps) return;
  double& expected_mps = forecast_->expected_mps[index];
  const double way_m = speed_mps * std::max(0.0, reach_s_ - blow.after_s);
  if (speed_mps <= expected_mps && way_m <= forecast_->way_m[index] + further_m) return;
  Blow& hardest = blows_[index];
  const bool first = hardest.momentum_kgmps <= 0;
  // Of two blows the harder one goes on, as early as the earlier one.
  const double after_s = first ? blow.after_s : std::min(blow.after_s, hardest.after_s);
  if (first || speed_mps > expected_mps)
    hardest = {blow.momentum_kgmps, blow.moving_kg + struck.mass_kg, after_s};
  hardest.after_s = after_s;
  expected_mps = std::max(expected_mps, speed_mps);
  disturb(index, speed_mps, blow.after_s);
  // Who waits already passes on the hardest that it will have taken by then.
  if (std::exchange(waits_[index], true)) return;
  front_.push_back(index);
}

void BlowForecast::compute(const MigrationSituation& s, const Motion& motion, Forecast& forecast) {
  forecast_ = &forecast;
  const auto count = static_cast<std::uint32_t>(s.hosted.size());
  const auto& [moving_mps, auras, boxes, grid] = motion;
  forecast.expected_mps.assign(count, 0.0);
  forecast.way_m.assign(count, 0.0);
  blows_.assign(count, {});
  waits_.assign(count, false);
  front_.clear();
  for (std::uint32_t i = 0; i < count; ++i) forecast.expected_mps[i] = std::max(moving_mps[i], 0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (moving_mps[i] < 0) continue;
    const HostedBody& striking = s.hosted[i];
    found_.clear();
    grid.find(boxes[i], found_);
    for (std::uint32_t other : found_) {
      if (other == i || !overlap(auras[i], auras[other])) continue;
      const HostedBody& struck = s.hosted[other];
      const double restitution = striking.restitution * struck.restitution;
      const double closing = moving_mps[i] + std::max(moving_mps[other], 0.0);
      const double gap = gap_m(room_of(striking), room_of(struck));
      const double after_s = std::max(0.0, gap) / (closing + gravity_mps2 * reach_s_);
      disturb(i, moving_mps[i], after_s);
      if (moving_mps[other] > 0) disturb(other, moving_mps[other], after_s);
      if (striking.deed_speed_mps > 0)
        strike(struck, other,
               {striking.deed_mass_kg * striking.deed_speed_mps, striking.deed_mass_kg},
               restitution);
      strike(struck, other, {striking.mass_kg * closing, striking.mass_kg, after_s}, restitution);
    }
  }
  for (const RemoteAura& aura : s.remote) {
    found_.clear();
    grid.find(aura.room.box(), found_);
    for (std::uint32_t other : found_) {
      if (!overlap(aura.room, auras[other])) continue;
      const HostedBody& struck = s.hosted[other];
      const double closing = aura.speed_mps + std::max(moving_mps[other], 0.0);
      if (moving_mps[other] > 0) disturb(other, moving_mps[other], 0);
      if (!aura.resting)
        strike(struck, other, {aura.mass_kg * closing, aura.mass_kg}, struck.restitution);
    }
  }
  if (s.contacts != nullptr) pass_on(s, grid);
}

/// Sorts what is around a struck body into what it touches and what it may fly into.
void BlowForecast::look_around(const MigrationSituation& s, const OverlapGrid& grid,
                               std::uint32_t from, double flight_m) {
  const HostedBody& body = s.hosted[from];
  near_.clear();
  const auto partners = s.contacts->touching(from);
  touched_.assign(partners.begin(), partners.end());
  leaning_on_ = s.contacts->leaning_on(from);
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

void BlowForecast::pass_on(const MigrationSituation& s, const OverlapGrid& grid) {
  for (std::size_t k = 0; k < front_.size(); ++k) {
    const std::uint32_t from = front_[k];
    waits_[from] = false;
    const HostedBody& body = s.hosted[from];
    const Blow taken = blows_[from];
    const double speed_mps = forecast_->expected_mps[from];
    look_around(s, grid, from, speed_mps * std::max(0.0, reach_s_ - taken.after_s));
    // One of them is where the blow came from. Those of other servers count too: their owners hear
    // of our aura.
    const auto onward = static_cast<double>(std::max<std::size_t>(leaning_on_, 2) - 1);
    Blow share = taken;
    share.momentum_kgmps *= std::min(1.0, unevenness / onward);
    for (std::uint32_t to : touched_)
      strike(s.hosted[to], to, share, body.restitution * s.hosted[to].restitution);
    for (std::uint32_t to : near_) {
      const double gap = gap_m(room_of(body), room_of(s.hosted[to]));
      const Blow alone{body.mass_kg * speed_mps, body.mass_kg,
                       taken.after_s + std::max(0.0, gap) / speed_mps};
      if (alone.after_s < reach_s_)
        strike(s.hosted[to], to, alone, body.restitution * s.hosted[to].restitution);
    }
  }
}

}  // namespace aureole
