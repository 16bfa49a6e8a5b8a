// What a region remembers of bodies that were here a short while ago.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

/// The body has existed under this version, or was removed on purpose under it.
struct Trace {
  BodyId id;
  Version version;
  bool removed = false;
};

/// A body that moves between two regions while a third one asks both could be missed by both
/// answers; its trace is not. Bounded in time and number.
class Traces {
 public:
  /// Longer than any round of questions lasts, which is a few round trips.
  static constexpr std::int64_t remember_ticks = ticks_from_ms(60'000);
  static constexpr std::size_t capacity = 65'536;

  void remember(const Trace& trace, Tick now);
  void prune(Tick now);
  /// Ascending by body; the newest of each.
  std::vector<Trace> all() const;

 private:
  struct Kept {
    Trace trace;
    std::uint64_t number = 0;
  };
  struct Order {
    Tick since;
    BodyId id;
    std::uint64_t number = 0;
  };
  void drop_oldest();

  std::map<BodyId, Kept> kept_;
  std::deque<Order> order_;  ///< Oldest first; those with another number than the body's are past.
  std::uint64_t last_number_ = 0;
};

}  // namespace aureole
