// Warnings that strangers can cause as often as they like.
#pragma once

#include <spdlog/spdlog.h>

#include <cstdint>
#include <string>

#include "server/net/world_clock.h"

namespace aureole {

/// Logs a few a second; how many more there were stands in the next one.
class RareWarning {
 public:
  static constexpr int per_second = 5;

  void say(const std::string& sentence) {
    const std::string line = line_at(monotonic_us(), sentence);
    if (!line.empty()) spdlog::warn("{}", line);
  }

  /// What is said at that moment (µs); empty: nothing.
  std::string line_at(std::int64_t now_us, const std::string& sentence) {
    if (now_us - began_us_ >= 1'000'000) {
      began_us_ = now_us;
      said_ = 0;
    }
    if (said_ >= per_second) {
      ++unsaid_;
      return {};
    }
    ++said_;
    std::string line = sentence;
    if (unsaid_ > 0) line += fmt::format(" ({} more such before that)", unsaid_);
    unsaid_ = 0;
    return line;
  }

 private:
  std::int64_t began_us_ = -1'000'000;
  int said_ = 0;
  std::uint64_t unsaid_ = 0;
};

}  // namespace aureole
