// What a run was measured to take, put together by buckets of 5 s of world time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "server/aura/shapes/aura_radius.h"
#include "server/base/tick.h"
#include "server/measure/measured/measured_run.h"

namespace aureole {

/// A run's ticks 1 … last, cut into buckets; the last bucket ends with the run.
class BucketClock {
 public:
  static constexpr std::int64_t bucket_us = 5'000'000;
  explicit BucketClock(double seconds)
      : seconds_(seconds), last_{static_cast<std::int64_t>(seconds * 1e6) / tick_us} {}

  Tick last() const { return last_; }
  std::size_t of(Tick tick) const {
    return static_cast<std::size_t>((tick.value * tick_us - 1) / bucket_us);
  }
  std::size_t count() const { return of(last_) + 1; }
  double end_s(std::size_t bucket) const;
  bool ends_with(Tick tick) const { return tick == last_ || of(tick + 1) != of(tick); }

 private:
  double seconds_;
  Tick last_;
};

/// Frame times of all repeats, counts of the last one (they are the same in each).
class RunRecord {
 public:
  RunRecord(std::size_t servers, double seconds,
            double frame_limit_ms = AuraTolerances{}.frame_time_ms);

  void begin_repeat();
  /// After each tick of the run.
  void note(Tick now, const MeasuredRun& run);

  const BucketClock& clock() const { return clock_; }
  /// The busiest server's mean frame in the buckets from `first` to the end, or to `end`.
  FrameTime worst_server(std::size_t first, std::size_t end) const;
  FrameTime worst_server(std::size_t bucket) const { return worst_server(bucket, bucket + 1); }
  /// The mean frame of the server that half of all do not pass, in the same buckets.
  double median_server_ms(std::size_t first, std::size_t end) const;
  nlohmann::json to_json(std::size_t bucket) const;
  /// Of the buckets from `first` to `end`: how often tolerances were kept, by ticks.
  nlohmann::json tolerances(std::size_t first, std::size_t end) const;

 private:
  struct Bucket {
    std::uint64_t ticks = 0;         ///< Of all repeats.
    std::vector<FrameTime> sums_ms;  ///< By server.
    std::vector<double> maxima_ms;   ///< By repeat, of all servers.
    std::vector<float> frames_ms;    ///< All of them.
    /// Ticks in which any server was outside of each tolerance, and of any.
    std::array<std::uint64_t, ToleranceEvent::kinds> outside{};
    std::uint64_t outside_any = 0;
    bool keeps_tolerances = false;
    std::optional<double> latency_tolerance_ms;  ///< At the end.
    std::vector<ServerLoad> loads;               ///< At the bucket's end, like all that follows.
    std::vector<LinkTraffic> traffic;            ///< Since the start.
    std::uint64_t migrations = 0;                ///< Since the start.
  };
  nlohmann::json links(std::size_t bucket) const;
  void note_tolerances(Bucket& bucket, const MeasuredRun& run, double longest_frame_ms) const;
  std::vector<FrameTime> means(std::size_t first, std::size_t end) const;

  BucketClock clock_;
  double frame_limit_ms_;
  std::vector<Bucket> buckets_;
};

}  // namespace aureole
