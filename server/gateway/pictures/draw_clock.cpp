// Lateness of each region's states by percentile, and a delay that slews towards the latest of
// them.
#include "server/gateway/pictures/draw_clock.h"

#include <algorithm>
#include <vector>

namespace aureole {
namespace {

/// Two seconds of ticks.
constexpr std::size_t samples_kept = 125;
/// Of the last states, one in twenty may come later than drawing waits: a single hiccup that holds
/// up a handful of ticks does not set the whole world back.
constexpr double share_in_time = 0.95;
/// A difference that slewing would take seconds to close is jumped over (forwards only).
constexpr std::int64_t jump_us = 250'000;
/// The world started again if it is this far behind what was drawn.
constexpr std::int64_t restart_us = 2'000'000;
/// Share of local time by which drawn time may run slower (to wait) or faster (to catch up).
constexpr double slower = 0.05, faster = 0.01;

}  // namespace

void DrawClock::arrived(RegionId region, Tick tick, std::int64_t local_us) {
  auto& samples = lateness_us_[region];
  const std::int64_t lateness = local_us - tick.value * tick_us;
  // A region whose ticks have jumped (a restart of the world) makes its old samples meaningless.
  if (!samples.empty() && std::abs(lateness - samples.back()) > restart_us) samples.clear();
  samples.push_back(lateness);
  if (samples.size() > samples_kept) samples.pop_front();
}

void DrawClock::forget(RegionId region) {
  lateness_us_.erase(region);
}

std::optional<std::int64_t> DrawClock::wanted_delay_us() const {
  std::optional<std::int64_t> latest;
  std::vector<std::int64_t> sorted;
  for (const auto& [region, samples] : lateness_us_) {
    sorted.assign(samples.begin(), samples.end());
    const auto index =
        static_cast<std::ptrdiff_t>(share_in_time * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + index, sorted.end());
    const std::int64_t lateness = sorted[static_cast<std::size_t>(index)];
    latest = latest ? std::max(*latest, lateness) : lateness;
  }
  if (!latest) return std::nullopt;
  return *latest + reserve_us;
}

std::optional<std::int64_t> DrawClock::world_us(std::int64_t local_us) {
  const auto wanted = wanted_delay_us();
  if (!wanted) return last_world_us_;  // all regions are gone: the world stands still
  if (!last_world_us_) {
    delay_us_ = *wanted;
  } else {
    const std::int64_t passed = std::max<std::int64_t>(local_us - last_local_us_, 0);
    const std::int64_t difference = *wanted - delay_us_;
    if (std::abs(difference) > jump_us)
      delay_us_ = *wanted;
    else
      delay_us_ +=
          std::clamp(difference, -static_cast<std::int64_t>(faster * static_cast<double>(passed)),
                     static_cast<std::int64_t>(slower * static_cast<double>(passed)));
  }
  std::int64_t world = local_us - delay_us_;
  if (last_world_us_ && world < *last_world_us_ && *last_world_us_ - world < restart_us)
    world = *last_world_us_;
  last_world_us_ = world;
  last_local_us_ = local_us;
  return world;
}

}  // namespace aureole
