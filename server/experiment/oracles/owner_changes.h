// Rule 4: how often bodies change their owner within a second.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <iterator>
#include <map>
#include <vector>

#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

struct OwnerChange {
  BodyId id;
  Tick tick;
  RegionId from, to;
};

class OwnerChanges {
 public:
  /// Any window of so many ticks counts: one second.
  static constexpr std::int64_t window_ticks = 62;

  /// The body has changed its owner. Returns how often it did in the window that ends now. Ticks
  /// may come a little out of order: servers take them at different moments.
  std::uint64_t add(const OwnerChange& change) {
    const auto& [id, tick, from, to] = change;
    recent_.push_back(change);
    while (tick - recent_.front().tick > 4 * window_ticks) recent_.pop_front();
    std::vector<Tick>& own = of_body_[id];
    std::erase_if(own, [&, at = tick](Tick t) { return at - t >= window_ticks; });
    own.push_back(tick);
    max_ = std::max<std::uint64_t>(max_, own.size());
    return own.size();
  }
  /// How often the body has changed its owner in the window that ends now.
  std::uint64_t recent(BodyId id, Tick now) const {
    const auto own = of_body_.find(id);
    if (own == of_body_.end()) return 0;
    return static_cast<std::uint64_t>(std::count_if(
        own->second.begin(), own->second.end(), [&](Tick t) { return now - t < window_ticks; }));
  }
  /// Most changes of one body in one window.
  std::uint64_t max() const { return max_; }
  /// Changes of all bodies at or after this tick, at most four windows ago.
  std::vector<OwnerChange> since(Tick tick) const {
    std::vector<OwnerChange> late;
    std::copy_if(recent_.begin(), recent_.end(), std::back_inserter(late),
                 [&](const OwnerChange& c) { return c.tick >= tick; });
    return late;
  }

 private:
  std::deque<OwnerChange> recent_;
  std::map<BodyId, std::vector<Tick>> of_body_;
  std::uint64_t max_ = 0;
};

}  // namespace aureole
