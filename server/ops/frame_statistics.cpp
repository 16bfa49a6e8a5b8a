// A ring of recent durations; the order statistics are found when somebody asks.
#include "server/ops/frame_statistics.h"

#include <algorithm>

namespace aureole {

void FrameStatistics::add(std::int64_t duration_us) {
  recent_us_[count_ % window] = duration_us;
  ++count_;
  if (duration_us > budget_us_) ++overruns_;
}

double FrameStatistics::p50_ms() const {
  const std::size_t n = filled();
  if (n == 0) return 0;
  auto sorted = recent_us_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((n - 1) / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(n));
  return static_cast<double>(*middle) / 1000.0;
}

double FrameStatistics::max_ms() const {
  const std::size_t n = filled();
  if (n == 0) return 0;
  const auto end = recent_us_.begin() + static_cast<std::ptrdiff_t>(n);
  return static_cast<double>(*std::max_element(recent_us_.begin(), end)) / 1000.0;
}

}  // namespace aureole
