// Coming and going.
#include "server/aura/sleepers.h"

#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {

void Sleepers::put(const HostedBody& body) {
  take(body.id);
  Place place = static_cast<Place>(sleepers_.size());
  if (free_.empty()) {
    sleepers_.emplace_back();
  } else {
    place = free_.back();
    free_.pop_back();
  }
  by_id_.emplace(body.id, place);
  const AuraCapsule aura = resting_aura(body);
  sleepers_[place] = {body, aura, aura.box(), not_beyond};
  note_whether_beyond(place);
  rows_.insert(place, sleepers_[place].box);
}

void Sleepers::move_home(const Rectangle& home) {
  home_ = home;
  beyond_.clear();
  // Side by side as they lie in memory, not as their names lead to them.
  for (Place place = 0; place < sleepers_.size(); ++place)
    if (sleepers_[place].beyond != nobody) note_whether_beyond(place);
}

void Sleepers::note_whether_beyond(Place place) {
  Sleeper& sleeper = sleepers_[place];
  sleeper.beyond = not_beyond;
  if (home_.holds(footprint(sleeper.box))) return;
  sleeper.beyond = static_cast<std::uint32_t>(beyond_.size());
  beyond_.push_back(place);
}

bool Sleepers::take(BodyId id) {
  const auto at = by_id_.find(id);
  if (at == by_id_.end()) return false;
  const Place place = at->second;
  rows_.erase(place, sleepers_[place].box);
  if (const std::uint32_t hole = sleepers_[place].beyond; hole != not_beyond) {
    beyond_[hole] = beyond_.back();
    sleepers_[beyond_[hole]].beyond = hole;
    beyond_.pop_back();
  }
  by_id_.erase(at);
  sleepers_[place].beyond = nobody;
  free_.push_back(place);
  return true;
}

std::optional<Sleepers::Place> Sleepers::place_of(BodyId id) const {
  const auto at = by_id_.find(id);
  return at == by_id_.end() ? std::nullopt : std::optional(at->second);
}

}  // namespace aureole
