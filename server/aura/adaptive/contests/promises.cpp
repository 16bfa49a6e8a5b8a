// Giving, and reckoning what has come of it by what others tell.
#include "server/aura/adaptive/contests/promises.h"

#include <algorithm>

namespace aureole {
namespace {

/// What is so near to a cluster, and to where it may soon get, may be part of it by now (m).
constexpr double merging_m = 2.0;

}  // namespace

void Promises::begin(const MigrationSituation& s) {
  situation_ = &s;
  std::erase_if(promises_,
                [&](const auto& entry) { return s.now - entry.second.at > hold_ticks_; });
}

Company::Hold Promises::give(BodyId body, RegionId to, Company::Hold known) {
  const Tick now = situation_->now;
  const Promise fresh{to, now, now, known};
  Promise& promise = promises_.try_emplace(body, fresh).first->second;
  const bool left_out = now - promise.at > decision_ticks;
  if (promise.to != to || left_out || known > promise.known) promise = fresh;
  promise.at = now;
  return promise.known;
}

const Promises::Promise* Promises::of(BodyId body) const {
  const auto at = promises_.find(body);
  return at == promises_.end() ? nullptr : &at->second;
}

/// Whether an aura's body has lately been asked for, and its host does not hold it back: of that
/// we have been told by now.
bool Promises::is_coming(const RemoteAura& aura) const {
  const Promise* promise = of(aura.id);
  if (promise == nullptr || promise->to != situation_->self) return false;
  const bool held_back = aura.company.hold() > promise->known;
  return !held_back && situation_->now - promise->since <= hold_ticks_;
}

void Promises::note_coming() {
  std::set<TheirCluster> clusters;
  for (const RemoteAura& aura : situation_->remote)
    if (aura.company.label != 0 && is_coming(aura))
      clusters.insert({aura.host, aura.company.label});
  coming_.clear();
  std::vector<AuraBox> boxes;
  for (const RemoteAura& aura : situation_->remote) {
    if (!clusters.contains({aura.host, aura.company.label}) && !is_coming(aura)) continue;
    coming_.push_back(aura.host);
    boxes.push_back(aura.room.box());
  }
  coming_rows_.build(boxes);
}

bool Promises::may_come(const RemoteAura& aura) const {
  if (is_coming(aura)) return true;
  if (coming_.empty()) return false;
  AuraBox room = aura.room.box();
  room.half.array() += merging_m + aura.speed_mps * reach_s_;
  std::vector<std::uint32_t> found;
  coming_rows_.find(room, found);
  return std::any_of(found.begin(), found.end(),
                     [&](std::uint32_t i) { return coming_[i] == aura.host; });
}

}  // namespace aureole
