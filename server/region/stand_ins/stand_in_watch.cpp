// Loads of stand-ins against their base.
#include "server/region/stand_ins/stand_in_watch.h"

#include <algorithm>

namespace aureole {
namespace {

/// Contacts flicker: a pair that is gone for longer begins anew.
constexpr std::int64_t absent_ticks = 8;

}  // namespace

void StandInWatch::judge(const StandInLoad& load, Tick now, bool still, double mass_kg) {
  const auto [at, fresh] = pairs_.try_emplace({load.stand_in, load.body});
  Pair& pair = at->second;
  if (fresh) {
    pair.first = now;
    pair.cut_at_rest = still;
  }
  pair.last = now;
  const double rise_mps = double{load.impulse_ns - pair.base_ns} / mass_kg;
  const bool settling = pair.cut_at_rest && now - pair.first < settling_ticks;
  if (settling && (fresh || rise_mps < blow_mps)) {
    pair.base_ns = std::max(pair.base_ns, load.impulse_ns);
    return;
  }
  if (rise_mps <= pressed_mps) return;
  pressed_[load.body] = now + pressed_ticks;
  if (rise_mps <= missed_mps || pair.struck) return;
  pair.struck = true;
  ++struck_;
  struck_now_.push_back({load.stand_in, load.body, now, rise_mps});
}

void StandInWatch::forget(Tick now) {
  std::erase_if(pairs_, [&](const auto& p) { return now - p.second.last > absent_ticks; });
  std::erase_if(pressed_, [&](const auto& p) { return p.second < now; });
}

bool StandInWatch::is_pressed(BodyId body, Tick now) const {
  const auto at = pressed_.find(body);
  return at != pressed_.end() && at->second >= now;
}

void StandInWatch::append_pressed(Tick now, std::vector<BodyId>& bodies) const {
  for (const auto& [body, until] : pressed_)
    if (until >= now) bodies.push_back(body);
}

}  // namespace aureole
