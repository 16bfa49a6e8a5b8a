// Where one body was at its last few ticks, and so where it is at any moment between them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "protocol/quantise.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"

namespace aureole {

/// A pose on the world-wide quantisation grid. Grid points are exact floats (24 bits an axis).
struct GridPose {
  Eigen::Vector3f position{0, 0, 0};  ///< m, world coordinates
  Eigen::Quaternion<float, Eigen::DontAlign> orientation{1, 0, 0, 0};

  static GridPose from(const QuantisedPosition& position, const QuantisedOrientation& orientation);
};

/// A ring without allocations. Ticks grow from entry to entry.
class PoseHistory {
 public:
  static constexpr std::size_t capacity = 8;

  bool empty() const { return count_ == 0; }
  /// Tick of the newest pose. Requires !empty().
  Tick newest_tick() const { return back(0).tick; }

  /// The body is at `pose` after step `tick`. Poses of that tick and of later ones are forgotten:
  /// whoever speaks now knows better.
  void push(Tick tick, const GridPose& pose);
  /// The body has not moved up to `tick`. Requires !empty().
  void hold_until(Tick tick);

  /// Interpolated between the two poses around world time `world_us`; the newest one if it is later
  /// than all, the oldest one if it is earlier. At a tick it is exactly the pose of that tick.
  /// Requires !empty().
  void at(std::int64_t world_us, WorldPosition& position, Eigen::Quaternionf& orientation) const;

 private:
  struct Entry {
    Tick tick;
    GridPose pose;
  };
  /// The n-th newest.
  const Entry& back(std::size_t n) const { return entries_[(end_ - 1 - n) % capacity]; }

  std::array<Entry, capacity> entries_{};
  std::uint32_t end_ = 0;    ///< Counts pushes; wraps without harm, as capacity divides 2^32.
  std::uint32_t count_ = 0;  ///< 0 … capacity
};

}  // namespace aureole
