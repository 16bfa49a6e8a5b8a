// When servers and links were outside of their tolerances: the truth that missed interactions are
// excused by.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/shapes/aura_radius.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/region/region_core.h"

namespace aureole {

/// Fed by the simulation, which knows every delay that it made, and by the cores' own events. Only
/// the tick at which a core says that something was left counts, not all the time until it says
/// that it is back: a core that forgets to say so must not be excused for ever.
class ToleranceRecord {
 public:
  static constexpr Tick long_ago{-1'000'000};

  ToleranceRecord(std::size_t regions, const AuraTolerances& tolerances,
                  MigrationMode mode = MigrationMode::adaptive)
      : regions_(regions),
        mode_(mode),
        flight_ticks_(flight_ticks_of(tolerances)),
        notice_ticks_(notice_ticks_of(tolerances)),
        servers_(regions, long_ago),
        links_(regions * regions, long_ago) {}

  /// T_T of the tolerances in force, in ticks.
  std::int64_t flight_ticks() const { return flight_ticks_; }
  /// For how long a body must have been there so that nothing of it is missed: T_T, or the longer
  /// reach time of the adaptive mode.
  std::int64_t notice_ticks() const { return notice_ticks_; }
  /// Servers whose tolerances follow the latency have so long ones now, the longest counts.
  void follow(const AuraTolerances& tolerances) {
    flight_ticks_ = flight_ticks_of(tolerances);
    notice_ticks_ = notice_ticks_of(tolerances);
  }

  void server_outside(RegionId region, Tick at) {
    Tick& last = servers_[region.value];
    last = std::max(last, at);
  }
  void link_outside(RegionId a, RegionId b, Tick at) {
    for (auto& last : {&links_[place(a, b)], &links_[place(b, a)]}) *last = std::max(*last, at);
  }
  void take(RegionId self, std::span<const ToleranceEvent> events) {
    for (const ToleranceEvent& e : events) {
      if (!e.outside) continue;
      if (e.kind == ToleranceEvent::Kind::frame_time) server_outside(self, e.tick);
      const bool link =
          e.kind == ToleranceEvent::Kind::latency || e.kind == ToleranceEvent::Kind::link;
      if (link && e.peer.value < regions_) link_outside(self, e.peer, e.tick);
    }
  }

  Tick server(RegionId region) const { return servers_[region.value]; }
  Tick link(RegionId a, RegionId b) const { return links_[place(a, b)]; }
  /// The server or any of its links.
  Tick anything_at(RegionId region) const {
    Tick last = server(region);
    for (std::uint16_t other = 0; other < regions_; ++other)
      last = std::max(last, link(region, RegionId{other}));
    return last;
  }
  bool excuses(Tick outside, Tick now) const { return now - outside <= window_ticks(); }
  /// T_T + 1 s: as long as what began outside is excused at most.
  std::int64_t window_ticks() const { return ticks_from_ms(1000) + flight_ticks_; }

 private:
  static std::int64_t flight_ticks_of(const AuraTolerances& t) {
    return static_cast<std::int64_t>(3 * steps_in_flight(t)) - 1;
  }
  std::int64_t notice_ticks_of(const AuraTolerances& t) const {
    return mode_ == MigrationMode::adaptive ? reach_ticks(t) : flight_ticks_of(t);
  }
  std::size_t place(RegionId a, RegionId b) const { return a.value * regions_ + b.value; }
  std::size_t regions_;
  MigrationMode mode_;
  std::int64_t flight_ticks_;
  std::int64_t notice_ticks_;
  std::vector<Tick> servers_;
  std::vector<Tick> links_;
};

}  // namespace aureole
