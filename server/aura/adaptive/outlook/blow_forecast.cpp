// Blows from what moves, through contacts, until they are too weak to matter.
#include "server/aura/adaptive/outlook/blow_forecast.h"

#include <algorithm>
#include <utility>

#include "server/aura/adaptive/outlook/aura_size.h"

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

void BlowForecast::disturb(std::uint32_t number, double speed_mps, double after_s) {
  Forecast::Fate& fate = forecast_->of(number);
  fate.way_m = std::max(fate.way_m, speed_mps * std::max(0.0, reach_s_ - after_s));
  fate.left_alone_s = std::min(fate.left_alone_s, after_s);
}

void BlowForecast::strike(std::uint32_t number, const Blow& blow, double restitution) {
  const HostedBody& struck = stage_->body(number);
  const double speed_mps = blow.speed_mps(struck.mass_kg, restitution);
  if (speed_mps < blow_speed_min_mps) return;
  Forecast::Fate& fate = forecast_->of(number);
  fate.left_alone_s = std::min(fate.left_alone_s, blow.after_s);
  fate.struck_mps = std::max(fate.struck_mps, speed_mps);
  const double way_m = speed_mps * std::max(0.0, reach_s_ - blow.after_s);
  if (speed_mps <= fate.expected_mps && way_m <= fate.way_m + further_m) return;
  Blow& hardest = fate.blow;
  const bool first = hardest.momentum_kgmps <= 0;
  // Of two blows the harder one goes on, as early as the earlier one.
  const double after_s = first ? blow.after_s : std::min(blow.after_s, hardest.after_s);
  if (first || speed_mps > fate.expected_mps)
    hardest = {blow.momentum_kgmps, blow.moving_kg + struck.mass_kg, after_s};
  hardest.after_s = after_s;
  fate.expected_mps = std::max(fate.expected_mps, speed_mps);
  disturb(number, speed_mps, blow.after_s);
  // Who waits already passes on the hardest that it will have taken by then.
  if (std::exchange(fate.waits, true)) return;
  front_.push_back(number);
}

/// Whether strike() changes nothing, be it with this blow or with one as hard that comes later.
bool BlowForecast::is_known(std::uint32_t number, const Blow& blow, double restitution) const {
  const double speed_mps = blow.speed_mps(stage_->body(number).mass_kg, restitution);
  if (speed_mps < blow_speed_min_mps) return true;
  if (number >= forecast_->size()) return false;
  const Forecast::Fate& fate = forecast_->fates_[number];
  return fate.left_alone_s <= blow.after_s && speed_mps <= fate.struck_mps &&
         speed_mps <= fate.expected_mps &&
         speed_mps * std::max(0.0, reach_s_ - blow.after_s) <= fate.way_m + further_m;
}

/// Whether the body's aura overlaps one of another server's.
bool BlowForecast::meets_others(std::uint32_t number, const BoxRows& remote_rows) {
  found_.clear();
  remote_rows.find(stage_->box(number), found_);
  return std::any_of(found_.begin(), found_.end(), [&](std::uint32_t other) {
    return overlap(remote_[other].room, stage_->aura(number));
  });
}

void BlowForecast::compute(const MigrationSituation& s, Stage& stage,
                           std::span<const double> moving_mps, const BoxRows& remote_rows,
                           Forecast& forecast) {
  forecast_ = &forecast;
  stage_ = &stage;
  remote_ = s.remote;
  forecast.clear();
  front_.clear();
  const auto count = static_cast<std::uint32_t>(moving_mps.size());
  for (std::uint32_t i = 0; i < count; ++i)
    forecast.of(i).expected_mps = std::max(moving_mps[i], 0.0);
  const auto own_mps = [&](std::uint32_t number) {
    return number < count ? std::max(moving_mps[number], 0.0) : 0.0;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (moving_mps[i] < 0) continue;
    if (meets_others(i, remote_rows)) disturb(i, moving_mps[i], 0);
    const HostedBody& striking = stage.body(i);
    found_.clear();
    stage.find(stage.box(i), found_);
    for (const std::uint32_t other : found_) {
      if (other == i || !overlap(stage.aura(i), stage.aura(other))) continue;
      const HostedBody& struck = stage.body(other);
      const double restitution = striking.restitution * struck.restitution;
      const double closing = moving_mps[i] + own_mps(other);
      const double gap = gap_m(room_of(striking), room_of(struck));
      const double after_s = std::max(0.0, gap) / (closing + gravity_mps2 * reach_s_);
      disturb(i, moving_mps[i], after_s);
      if (own_mps(other) > 0) disturb(other, own_mps(other), after_s);
      if (striking.deed_speed_mps > 0)
        strike(other, {striking.deed_mass_kg * striking.deed_speed_mps, striking.deed_mass_kg},
               restitution);
      strike(other, {striking.mass_kg * closing, striking.mass_kg, after_s}, restitution);
    }
  }
  for (const RemoteAura& aura : s.remote) {
    if (aura.resting) continue;
    found_.clear();
    stage.find(aura.room.box(), found_);
    for (const std::uint32_t other : found_) {
      if (!overlap(aura.room, stage.aura(other))) continue;
      strike(other, {aura.mass_kg * (aura.speed_mps + own_mps(other)), aura.mass_kg},
             stage.body(other).restitution);
    }
  }
  if (s.contacts != nullptr) pass_on();
}

/// Sorts what is around a struck body into what it touches and what it may fly into.
void BlowForecast::look_around(std::uint32_t from, double flight_m) {
  const HostedBody& body = stage_->body(from);
  near_.clear();
  leaning_on_ = stage_->find_touching(from, touched_);
  const bool flies = flight_m > contact_margin_m;
  if (!body.round && !flies) return;
  AuraBox reach{body.position.vector(), body.half_extents};
  reach.half.array() += std::max(flight_m, spheres_touch_m);
  found_.clear();
  stage_->find(reach, found_);
  for (const std::uint32_t other : found_) {
    if (other == from || std::find(touched_.begin(), touched_.end(), other) != touched_.end())
      continue;
    const HostedBody& next = stage_->body(other);
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

void BlowForecast::pass_on() {
  for (std::size_t k = 0; k < front_.size(); ++k) {
    const std::uint32_t from = front_[k];
    for (const FetchStep step : fetch_steps)
      if (const std::size_t next = k + places_ahead(step); next < front_.size())
        stage_->fetch_touching(front_[next], step);
    Forecast::Fate& fate = forecast_->of(from);
    fate.waits = false;
    const HostedBody& body = stage_->body(from);
    const Blow taken = fate.blow;
    const double speed_mps = fate.expected_mps;
    look_around(from, speed_mps * std::max(0.0, reach_s_ - taken.after_s));
    // One of them is where the blow came from. Those of other servers count too: their owners hear
    // of our aura.
    const auto onward = static_cast<double>(std::max<std::size_t>(leaning_on_, 2) - 1);
    Blow share = taken;
    share.momentum_kgmps *= std::min(1.0, unevenness / onward);
    for (const std::uint32_t to : touched_)
      strike(to, share, body.restitution * stage_->body(to).restitution);
    for (const std::uint32_t to : near_) {
      const double restitution = body.restitution * stage_->body(to).restitution;
      Blow alone{body.mass_kg * speed_mps, body.mass_kg, taken.after_s};
      // Half of them say nothing new, however near the two are.
      if (is_known(to, alone, restitution)) continue;
      const double gap = gap_m(room_of(body), room_of(stage_->body(to)));
      alone.after_s += std::max(0.0, gap) / speed_mps;
      if (alone.after_s < reach_s_) strike(to, alone, restitution);
    }
  }
}

}  // namespace aureole
