// The offset between this machine's clock and world time, filtered by the shortest round trips.
#include "server/net/world_clock.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>

namespace aureole {
namespace {

constexpr std::size_t samples_kept = 16;
constexpr std::int64_t jump_us = 100'000;

}  // namespace

std::int64_t monotonic_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void WorldClock::start_as_reference(std::int64_t local_us, std::int64_t world_us) {
  // A follower that takes over goes on with the time it has: the world's clock never steps.
  if (!offset_us_) offset_us_ = world_us - local_us;
  reference_ = true;
  samples_.clear();
}

void WorldClock::add_sample(std::int64_t sent_us, std::int64_t world_us, std::int64_t heard_us) {
  if (reference_ || heard_us < sent_us) return;
  const std::int64_t round_trip = heard_us - sent_us;
  samples_.push_back({round_trip, world_us + round_trip / 2 - heard_us, heard_us});
  if (samples_.size() > samples_kept) samples_.pop_front();
  const auto best = std::min_element(
      samples_.begin(), samples_.end(),
      [](const Sample& a, const Sample& b) { return a.round_trip_us < b.round_trip_us; });
  round_trip_us_ = best->round_trip_us;

  if (!offset_us_ || std::abs(best->offset_us - *offset_us_) > jump_us) {
    offset_us_ = best->offset_us;
  } else {
    const std::int64_t passed = std::max<std::int64_t>(heard_us - last_heard_us_, 0);
    const std::int64_t most = std::max<std::int64_t>(passed / 100, 1);
    *offset_us_ += std::clamp(best->offset_us - *offset_us_, -most, most);
  }
  last_heard_us_ = heard_us;
}

std::optional<std::int64_t> WorldClock::world_us(std::int64_t local_us) const {
  if (!offset_us_) return std::nullopt;
  return local_us + *offset_us_;
}

}  // namespace aureole
