// Rule 4: how often bodies change their owner within a second.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "server/base/ids.h"
#include "server/base/tick.h"

namespace aureole {

class OwnerChanges {
 public:
  /// Any window of so many ticks counts: one second.
  static constexpr std::int64_t window_ticks = 62;

  /// The body has changed its owner. Returns how often it did in the window that ends now. Ticks
  /// may come a little out of order: servers take them at different moments.
  std::uint64_t add(BodyId id, Tick tick) {
    recent_.push_back(tick);
    while (tick - recent_.front() > 4 * window_ticks) recent_.pop_front();
    std::vector<Tick>& own = of_body_[id];
    std::erase_if(own, [&](Tick t) { return tick - t >= window_ticks; });
    own.push_back(tick);
    max_ = std::max<std::uint64_t>(max_, own.size());
    return own.size();
  }
  /// Most changes of one body in one window.
  std::uint64_t max() const { return max_; }
  /// Changes of all bodies at or after this tick, at most four windows ago.
  std::uint64_t since(Tick tick) const {
    return static_cast<std::uint64_t>(
        std::count_if(recent_.begin(), recent_.end(), [&](Tick t) { return t >= tick; }));
  }

 private:
  std::deque<Tick> recent_;
  std::map<BodyId, std::vector<Tick>> of_body_;
  std::uint64_t max_ = 0;
};

}  // namespace aureole
