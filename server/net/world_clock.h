// World time on this machine: the local monotonic clock plus an offset learnt from a reference
// server.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "server/base/tick.h"

namespace aureole {

/// Monotonic time of this machine (µs).
std::int64_t monotonic_us();

/// The region with the lowest id that is linked is the reference; all others follow it. Pure: the
/// caller reads the clock. Every time is in µs.
class WorldClock {
 public:
  /// Makes this process the reference: world time is `world_us` at local time `local_us`.
  void start_as_reference(std::int64_t local_us, std::int64_t world_us);

  /// One exchange with the reference: asked at `sent_us`, answered with `world_us`, heard at
  /// `heard_us` (local). The sample with the shortest round trip of the last 16 sets the target;
  /// the offset moves towards it by at most 1 % of the time that passed, or jumps past 100 ms.
  /// Source: the clock filter of NTP (RFC 5905, section 10), reduced to its minimum filter.
  void add_sample(std::int64_t sent_us, std::int64_t world_us, std::int64_t heard_us);

  bool is_set() const { return offset_us_.has_value(); }
  bool is_reference() const { return reference_; }
  /// World time at local time `local_us`; nothing before the first sample.
  std::optional<std::int64_t> world_us(std::int64_t local_us) const;
  /// Local time at which the world reaches `world_us`. Requires is_set().
  std::int64_t local_us(std::int64_t world_us) const { return world_us - *offset_us_; }
  /// Shortest recent round trip to the reference (µs).
  std::int64_t round_trip_us() const { return round_trip_us_; }

 private:
  struct Sample {
    std::int64_t round_trip_us;
    std::int64_t offset_us;
    std::int64_t heard_us;
  };
  bool reference_ = false;
  std::optional<std::int64_t> offset_us_;
  std::int64_t last_heard_us_ = 0;
  std::int64_t round_trip_us_ = 0;
  std::deque<Sample> samples_;
};

}  // namespace aureole
