// Putting stand-ins up and taking them down.
#include "server/region/stand_ins/stand_ins.h"

#include <algorithm>

namespace aureole {
namespace {

bool same_pose(const BodyState& a, const BodyState& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

}  // namespace

void StandIns::note(BodyId id, const Entry& entry) {
  entries_[id] = entry;
  if (entry.vouched) {
    unvouched_.erase(id);
    return;
  }
  unvouched_from_ = unvouched_.empty() ? entry.since : std::min(unvouched_from_, entry.since);
  unvouched_[id] = entry.since;
}

void StandIns::drop(BodyId id) {
  entries_.erase(id);
  unvouched_.erase(id);
  away_.erase(id);
}

void StandIns::note_ours(std::span<const NewBody> bodies) {
  if (!ours_) return;
  for (const NewBody& body : bodies) ours_->note(body.state.position);
  if (ours_->take_grown()) put_up_what_is_near();
}

void StandIns::look_around() {
  if (!ours_) return;
  forget_bodies();
  ours_->forget_all();
  for (BodyId id : physics_.ids()) ours_->note(physics_.position(id));
  std::vector<BodyId> far;
  for (BodyId id : physics_.stand_in_ids()) {
    const NewBody body = physics_.stand_in(id);
    if (is_near_ours(body)) continue;
    far.push_back(id);
    away_.emplace(id, body);
  }
  physics_.remove_stand_ins(far, Wake::nobody);  // Nobody touches them.
  put_up_what_is_near();
}

void StandIns::put_up_what_is_near() {
  std::vector<NewBody> near;
  for (const auto& [id, body] : away_)
    if (is_near_ours(body)) near.push_back(body);
  for (const NewBody& body : near) away_.erase(body.id);
  // Who has become a body (born or claimed here under that name) stands for itself.
  std::erase_if(near, [&](const NewBody& body) {
    const bool hosted = physics_.contains(body.id);
    if (hosted) drop(body.id);
    return hosted;
  });
  if (near.empty()) return;
  std::vector<BodyId> ids;
  for (const NewBody& body : near) ids.push_back(body.id);
  physics_.add_stand_ins(near);
  physics_.wake_what_is_inside(ids, overlap_wakes_m);
}

void StandIns::put(const NewBody& body, const Entry& entry) {
  note(body.id, entry);
  if (!physics_.is_stand_in(body.id) && !is_near_ours(body)) {
    away_.insert_or_assign(body.id, body);
    return;
  }
  away_.erase(body.id);
  const bool other_thing =
      physics_.is_stand_in(body.id) && physics_.stand_in(body.id).prototype != body.prototype;
  if (other_thing) physics_.remove_stand_ins(std::span(&body.id, 1), Wake::touching);
  // Put up anew, it would lose the contacts that others have with it.
  if (physics_.is_stand_in(body.id) && same_pose(physics_.stand_in(body.id).state, body.state))
    return;
  physics_.add_stand_ins(std::span(&body, 1));
}

void StandIns::left(std::span<const BodyId> ids, RegionId to, Tick now) {
  for (BodyId id : ids) {
    away_.erase(id);
    note(id, {to, false, now});
  }
}

void StandIns::came_along(std::span<const NewBody> bodies, RegionId from, Tick now) {
  for (const NewBody& body : bodies) {
    if (physics_.contains(body.id) || entries_.contains(body.id)) continue;
    put(body, {from, false, now});
  }
}

void StandIns::arrived(std::span<const BodyId> ids) {
  for (BodyId id : ids) drop(id);
}

void StandIns::forget_bodies() {
  // Each stand-in has an entry: as long as there are as many, nobody has become a body.
  if (size() == physics_.stand_in_ids().size()) return;
  const auto is_none = [&](BodyId id) { return !physics_.is_stand_in(id) && !away_.contains(id); };
  std::erase_if(entries_, [&](const auto& entry) { return is_none(entry.first); });
  std::erase_if(unvouched_, [&](const auto& unvouched) { return is_none(unvouched.first); });
}

void StandIns::take(std::span<const RestingNews> news, Tick now) {
  forget_bodies();
  std::vector<BodyId> fresh;
  for (const RestingNews& item : news) {
    const BodyId id = item.body.id;
    if (item.kind == RestingNews::Kind::told_all) {
      for (const auto& [stand_in, entry] : entries_)
        if (entry.sponsor == item.from) note(stand_in, {entry.sponsor, false, now});
      continue;
    }
    if (item.kind == RestingNews::Kind::rests) {
      if (physics_.contains(id)) continue;
      if (!physics_.is_stand_in(id)) fresh.push_back(id);
      put(item.body, {item.from, true, now});
      continue;
    }
    const auto at = entries_.find(id);
    if (at == entries_.end() || at->second.sponsor != item.from) continue;
    if (item.kind == RestingNews::Kind::handed_over) {
      note(id, {item.from, false, now});
    } else {
      take_down(std::span(&id, 1));
    }
  }
  // Told, taken back and told again within one step it would be here twice.
  std::sort(fresh.begin(), fresh.end());
  fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
  std::erase_if(fresh, [&](BodyId id) { return !physics_.is_stand_in(id); });
  if (!fresh.empty()) physics_.wake_what_is_inside(fresh, overlap_wakes_m);
}

void StandIns::tidy(std::span<const RemoteAura> remote, Tick now) {
  forget_bodies();
  if (entries_.empty()) return;
  std::vector<BodyId> down;
  for (const RemoteAura& aura : remote)
    if (aura.left_its_place && entries_.contains(aura.id)) down.push_back(aura.id);
  if (now - unvouched_from_ > grace_ticks) {
    unvouched_from_ = now;
    for (const auto& [id, since] : unvouched_)
      if (now - since > grace_ticks)
        down.push_back(id);
      else
        unvouched_from_ = std::min(unvouched_from_, since);
  }
  std::sort(down.begin(), down.end());
  down.erase(std::unique(down.begin(), down.end()), down.end());
  take_down(down);
}

void StandIns::take_down(std::span<const BodyId> ids) {
  std::vector<BodyId> standing;
  for (BodyId id : ids) {
    if (!away_.contains(id)) standing.push_back(id);
    drop(id);
  }
  if (!standing.empty()) physics_.remove_stand_ins(standing, Wake::touching);
}

}  // namespace aureole
