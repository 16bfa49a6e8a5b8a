// What can be measured: servers, or worlds in their place, that take ticks and say what those took.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <numeric>
#include <optional>
#include <vector>

#include "server/region/step_profile.h"
#include "server/region/tolerances/tolerances.h"

namespace aureole {

/// CPU time of this thread (ns): others on the machine do not count.
inline std::int64_t thread_cpu_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// Time as it passes (ns): quick to ask.
inline std::int64_t steady_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Frames in CPU time. While something else has the core the part in work looks longer, at the cost
/// of the frame's other parts.
inline StepProfile::Clocks cpu_clocks() {
  return {&thread_cpu_ns, &steady_ns};
}

/// What one server spent on one tick (unit: ms), by StepProfile::Part.
using FrameTime = std::array<double, StepProfile::parts>;

inline double total_ms(const FrameTime& frame) {
  return std::accumulate(frame.begin(), frame.end(), 0.0);
}

inline FrameTime frame_time(const StepProfile& profile) {
  FrameTime frame{};
  for (std::size_t part = 0; part < frame.size(); ++part)
    frame[part] = static_cast<double>(profile.spent_ns()[part]) / 1e6;
  return frame;
}

struct ServerLoad {
  std::uint64_t bodies = 0, awake = 0;
  std::uint64_t foreign = 0;  ///< Bodies whose centres are in another region.
};

/// Since the start. Region numbers; the gateway is the number after them.
struct LinkTraffic {
  int from = 0, to = 0;
  std::uint64_t messages = 0, bytes = 0;
};

class MeasuredRun {
 public:
  virtual ~MeasuredRun() = default;
  /// Takes every server on by one tick of 16 ms.
  virtual void tick() = 0;
  /// Of the last tick, one for each server.
  virtual const std::vector<FrameTime>& frames() const = 0;
  virtual std::vector<ServerLoad> loads() const = 0;
  /// By ToleranceEvent::Kind: whether any server was outside of it at the end of the last tick. How
  /// long frames took is not known there. Nothing where nobody keeps tolerances.
  using Outside = std::array<bool, ToleranceEvent::kinds>;
  virtual std::optional<Outside> outside_tolerances() const { return {}; }
  /// The longest latency tolerance that any server keeps (ms).
  virtual std::optional<double> latency_tolerance_ms() const { return {}; }
  /// Changes of owner since the start.
  virtual std::uint64_t migrations() const = 0;
  /// Links that carried anything.
  virtual std::vector<LinkTraffic> traffic() const = 0;
  virtual std::uint64_t state_hash() const = 0;
  /// Messages that one side refused; none among honest ones.
  virtual std::uint64_t refused_messages() const = 0;
};

}  // namespace aureole
