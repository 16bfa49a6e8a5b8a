// Loads of stand-ins against their base.
#include "server/region/stand_ins/stand_in_watch.h"

#include <algorithm>
#include <utility>

#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {
namespace {

/// Contacts flicker: a pair that is gone for longer begins anew.
constexpr std::int64_t absent_ticks = 8;

}  // namespace

/// Notes who leans on other stand-ins than before: both lists ascend.
void StandInWatch::note_cut(std::span<const BodyId> stand_ins, Tick now) {
  // In most steps the same stand as in the one before.
  const Tick last_look = std::exchange(last_look_, now);
  if (!std::equal(stand_ins.begin(), stand_ins.end(), stand_ins_.begin(), stand_ins_.end())) {
    auto present = stand_ins.begin();
    for (const auto& [who, pair] : pairs_) {
      while (present != stand_ins.end() && *present < who.first) ++present;
      const bool is_gone = present == stand_ins.end() || *present != who.first;
      if (is_gone && pair.last == last_look) cut_anew_[who.second] = now;
    }
    auto known = stand_ins_.begin();
    for (const BodyId id : stand_ins) {
      while (known != stand_ins_.end() && *known < id) ++known;
      if (known == stand_ins_.end() || *known != id) fresh_[id] = now;
    }
    stand_ins_.assign(stand_ins.begin(), stand_ins.end());
  }
  std::erase_if(fresh_, [&](const auto& f) { return now - f.second >= settling_ticks; });
  if (fresh_.empty()) return;
  for (const StandInLoad& load : loads_)
    if (const auto at = fresh_.find(load.stand_in); at != fresh_.end()) {
      Tick& since = cut_anew_.try_emplace(load.body, at->second).first->second;
      since = std::max(since, at->second);
    }
}

bool StandInWatch::may_shift(BodyId body, Tick now) const {
  const auto at = cut_anew_.find(body);
  return at != cut_anew_.end() && now - at->second < settling_ticks;
}

void StandInWatch::judge(const StandInLoad& load, Tick now, bool still, const Masses& masses) {
  const auto [at, fresh] = pairs_.try_emplace({load.stand_in, load.body});
  Pair& pair = at->second;
  if (fresh) {
    pair.first = now;
    pair.cut_at_rest = still;
  }
  const bool flickered = !fresh && now - pair.last == 2;
  pair.last = now;
  const double rise_mps = double{load.impulse_ns - pair.base_ns} / masses.stand_in_kg;
  const bool settling = pair.cut_at_rest && now - pair.first < settling_ticks;
  if (settling && (fresh || rise_mps < blow_mps)) {
    pair.base_ns = std::max(pair.base_ns, load.impulse_ns);
    return;
  }
  if (rise_mps <= pressed_mps) return;
  pressed_[load.body] = now + pressed_ticks;
  if (still && rise_mps < blow_mps && may_shift(load.body, now)) {
    pair.shifted_ns = std::max(pair.shifted_ns, load.impulse_ns);
    return;
  }
  const double fell_ns = still && flickered ? masses.body_kg * gravity_mps2 * tick_s : 0;
  const double struck_mps =
      (double{load.impulse_ns - std::max(pair.base_ns, pair.shifted_ns)} - fell_ns) /
      masses.stand_in_kg;
  if (struck_mps <= missed_mps || pair.struck) return;
  pair.struck = true;
  ++struck_;
  struck_now_.push_back({load.stand_in, load.body, now, struck_mps});
}

void StandInWatch::forget(Tick now) {
  std::erase_if(pairs_, [&](const auto& p) { return now - p.second.last > absent_ticks; });
  std::erase_if(pressed_, [&](const auto& p) { return p.second < now; });
  std::erase_if(cut_anew_, [&](const auto& p) { return now - p.second >= settling_ticks; });
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
