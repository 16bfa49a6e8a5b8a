// Which moment of the world is drawn: as late as the states of all regions allow, and running
// evenly.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

/// Pure: local times come from the caller (µs, monotonic). Drawn time runs at the pace of the local
/// clock behind the newest states, so that interpolation nearly always has a state on either side;
/// the distance follows how late states come, slowly enough that nobody sees it. It never goes
/// back, but for a world that has started again (more than two seconds behind what was drawn).
class DrawClock {
 public:
  /// Distance to the newest tick that every region has reached, beyond how late ticks come (µs):
  /// the next state arrives one tick later, and a quarter is for jitter.
  static constexpr std::int64_t reserve_us = tick_us + tick_us / 4;

  /// A region's state after step `tick` arrived at `local_us`.
  void arrived(RegionId region, Tick tick, std::int64_t local_us);
  /// The region is gone: drawing no longer waits for it.
  void forget(RegionId region);

  /// World time to draw at local time `local_us` (µs); nothing until a region has been heard.
  std::optional<std::int64_t> world_us(std::int64_t local_us);
  /// How far drawing is behind local time less the fastest region's offset; for the status page
  /// (µs).
  std::int64_t delay_us() const { return delay_us_; }

 private:
  std::optional<std::int64_t> wanted_delay_us() const;

  /// Local arrival time less world time of the last states of each region.
  std::map<RegionId, std::deque<std::int64_t>> lateness_us_;
  std::optional<std::int64_t> last_world_us_;
  std::int64_t last_local_us_ = 0;
  std::int64_t delay_us_ = 0;
};

}  // namespace aureole
