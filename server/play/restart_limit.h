// How often something may be started again before one has to admit that it does not work.
#pragma once

#include <cstdint>
#include <deque>

namespace aureole {

/// At most `limit` restarts in any `window_ms`. Pure: the caller brings the time (ms, monotonic).
class RestartLimit {
 public:
  RestartLimit(std::size_t limit, std::int64_t window_ms) : limit_(limit), window_ms_(window_ms) {}

  /// Whether one more is allowed now; it is counted if so.
  bool allow(std::int64_t now_ms) {
    while (!restarts_ms_.empty() && restarts_ms_.front() <= now_ms - window_ms_) {
      restarts_ms_.pop_front();
    }
    if (restarts_ms_.size() >= limit_) return false;
    restarts_ms_.push_back(now_ms);
    return true;
  }

 private:
  std::size_t limit_;
  std::int64_t window_ms_;
  std::deque<std::int64_t> restarts_ms_;
};

}  // namespace aureole
