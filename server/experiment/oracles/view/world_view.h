// All servers at once: where every body was at one tick of world time, and who simulated it.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/region/handoff/handoff.h"
#include "server/region/region_core.h"

namespace aureole {

struct SeenBody {
  BodyId id;
  PrototypeId prototype;
  RegionId owner;
  BodyState state;
  /// How far off the pose may be (m): 0 where a server simulated it. In flight nobody does; it is
  /// laid on the line between its last state and its first one at the receiver.
  double uncertainty_m = 0;
};

/// A group that left a server in a step.
struct Departure {
  RegionId from, to;
  HandoffGroup group;
};

/// Servers take the same tick at different moments, so a tick is looked at `delay_ticks` after its
/// time, when all that are inside their tolerances have taken it long since. A server that has not
/// taken it (it was held up and left it out) counts with what it had before.
class WorldView {
 public:
  static constexpr std::int64_t delay_ticks = 12;
  /// Flights that last longer are not filled in: nobody simulated anything then.
  static constexpr std::int64_t flight_ticks_max = 8;

  explicit WorldView(std::size_t regions) : servers_(regions) {}

  /// After each step of a server; `departures` are those of this step.
  void stepped(RegionId region, Tick tick, const RegionCore& core,
               std::span<const Departure> departures);
  /// The server is gone from this tick on.
  void gone(RegionId region, Tick tick);

  /// Ascending by id, one entry a body; a body that two servers claim is the later one's. Call for
  /// ascending ticks.
  const std::vector<SeenBody>& at(Tick tick);

 private:
  struct Moment {
    Tick tick;
    std::vector<SeenBody> bodies;  ///< Ascending, those that left after the step included.
    std::vector<BodyId> left;      ///< Ascending.
  };
  struct Server {
    std::deque<Moment> moments;
    std::optional<Tick> gone_since;
  };
  struct Flight {
    Tick since;
    RegionId to;
    SeenBody last;
  };
  void fill_in_flights(Tick tick);
  std::optional<SeenBody> first_after(RegionId region, Tick tick, BodyId id, Tick& when) const;

  std::vector<Server> servers_;
  std::map<BodyId, Flight> flights_;
  std::vector<SeenBody> seen_;
};

}  // namespace aureole
