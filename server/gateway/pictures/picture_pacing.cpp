// The controller of window, quality and size.
#include "server/gateway/pictures/picture_pacing.h"

#include <algorithm>
#include <array>

namespace aureole {
namespace {

constexpr std::int64_t period_us = 500'000;
constexpr std::size_t floors_kept = 20;
constexpr std::array scales = {1.0, 0.75, 0.5};
/// Below this many pictures in a second, smaller ones are better than fewer.
constexpr double enough_per_s = 25;
/// This much later than the shortest round trip means that pictures queue up somewhere.
constexpr std::int64_t queueing_us = 60'000;
constexpr std::int64_t patience_start_us = 2'000'000, patience_max_us = 60'000'000;
/// A step up that is taken back within this time was a mistake.
constexpr std::int64_t trial_us = 5'000'000;

}  // namespace

PicturePacing::PicturePacing() : patience_us_(patience_start_us) {}

double PicturePacing::scale() const {
  return scales[static_cast<std::size_t>(scale_step_)];
}

void PicturePacing::sent(std::uint32_t number, std::int64_t now_us) {
  in_flight_.push_back({number, now_us});
  sent_us_.push_back(now_us);
  while (!sent_us_.empty() && now_us - sent_us_.front() > 1'000'000) sent_us_.pop_front();
}

void PicturePacing::acknowledged(std::uint32_t number, std::int64_t now_us) {
  while (!in_flight_.empty() && in_flight_.front().number <= number) {
    if (in_flight_.front().number == number) {
      const std::int64_t round_trip =
          std::max<std::int64_t>(now_us - in_flight_.front().sent_us, 1);
      period_floor_us_ =
          period_floor_us_ == 0 ? round_trip : std::min(period_floor_us_, round_trip);
      round_trips_us_ += round_trip;
      ++acknowledged_;
    }
    in_flight_.pop_front();
  }
}

double PicturePacing::fps(std::int64_t now_us) const {
  return static_cast<double>(std::count_if(
      sent_us_.begin(), sent_us_.end(), [&](std::int64_t at) { return now_us - at <= 1'000'000; }));
}

std::int64_t PicturePacing::shortest_round_trip_us() const {
  std::int64_t shortest = period_floor_us_;
  for (const std::int64_t floor : floors_us_)
    shortest = shortest == 0 ? floor : std::min(shortest, floor);
  return shortest;
}

void PicturePacing::tick(std::int64_t now_us) {
  if (period_start_us_ == 0) {
    period_start_us_ = calm_since_us_ = now_us;
    return;
  }
  if (now_us - period_start_us_ < period_us) return;
  adapt(now_us);
  if (period_floor_us_ != 0) floors_us_.push_back(period_floor_us_);
  if (floors_us_.size() > floors_kept) floors_us_.pop_front();
  period_start_us_ = now_us;
  period_floor_us_ = round_trips_us_ = 0;
  acknowledged_ = held_back_ = 0;
}

void PicturePacing::adapt(std::int64_t now_us) {
  const std::int64_t floor = shortest_round_trip_us();
  const double seconds = static_cast<double>(now_us - period_start_us_) / 1e6;
  const double acknowledged_per_s = acknowledged_ / seconds;
  const std::int64_t mean = acknowledged_ > 0 ? round_trips_us_ / acknowledged_ : 0;

  // As many pictures as fit on the way there and back, and two: one being decoded, one to spare.
  // The shortest round trip counts, so that a queue that has built up does not open the window
  // further.
  const auto on_the_way = static_cast<int>((floor + interval_us - 1) / interval_us);
  window_ = std::clamp(on_the_way + 2, window_min, window_max);

  const bool late = mean > 0 && mean - floor > queueing_us;
  const bool held = held_back_ > 0.25 * (held_back_ + acknowledged_);
  // Held back by nothing but a silent browser (a hidden tab): there is nothing to adapt to.
  if (acknowledged_ == 0) {
    calm_since_us_ = now_us;
  } else if (late || held) {
    lower(now_us, acknowledged_per_s);
  } else if (now_us - calm_since_us_ >= patience_us_) {
    raise(now_us);
  }
}

void PicturePacing::lower(std::int64_t now_us, double acknowledged_per_s) {
  calm_since_us_ = now_us;
  if (raised_at_us_ != 0 && now_us - raised_at_us_ < trial_us) {
    patience_us_ = std::min(2 * patience_us_, patience_max_us);
    raised_at_us_ = 0;
  }
  if (quality_ > quality_min)
    quality_ = std::max(quality_ - 10, quality_min);
  else if (acknowledged_per_s < enough_per_s && scale_step_ + 1 < static_cast<int>(scales.size()))
    ++scale_step_;
}

void PicturePacing::raise(std::int64_t now_us) {
  // It has gone well for so long that an earlier failure says little.
  if (raised_at_us_ != 0 && now_us - raised_at_us_ >= trial_us)
    patience_us_ = std::max(patience_us_ / 2, patience_start_us);
  calm_since_us_ = now_us;
  if (scale_step_ > 0)
    --scale_step_;
  else if (quality_ < quality_max)
    quality_ = std::min(quality_ + 5, quality_max);
  else
    return;
  raised_at_us_ = now_us;
}

}  // namespace aureole
