// How long steps or frames took lately: median, maximum, and how many overran their budget.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace aureole {

/// Pure; durations in µs go in, milliseconds come out. Looks back over the last `window` durations
/// (512 steps of 16 ms are 8 s); overruns and the count are since the start.
class FrameStatistics {
 public:
  static constexpr std::size_t window = 512;

  /// `budget_us`: longer durations are overruns.
  explicit FrameStatistics(std::int64_t budget_us) : budget_us_(budget_us) {}

  void add(std::int64_t duration_us);

  /// Median of the window (ms): the lower of the two middle ones if their number is even. 0 if
  /// empty.
  double p50_ms() const;
  /// Maximum of the window (ms). 0 if empty.
  double max_ms() const;
  std::uint64_t overruns() const { return overruns_; }
  std::uint64_t count() const { return count_; }

 private:
  std::size_t filled() const { return count_ < window ? static_cast<std::size_t>(count_) : window; }

  std::int64_t budget_us_;
  std::uint64_t overruns_ = 0;
  std::uint64_t count_ = 0;
  std::array<std::int64_t, window> recent_us_{};
};

}  // namespace aureole
