// Regions by their areas, servers by the auras that they project.
#include "server/aura/adaptive/contests/neighbourhood.h"

#include <algorithm>
#include <utility>

#include "server/aura/adaptive/homecoming.h"
#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {

void Neighbourhood::begin(const MigrationSituation& situation, const Outlook& outlook,
                          const Clusters& clusters) {
  situation_ = &situation;
  outlook_ = &outlook;
  clusters_ = &clusters;
  of_cluster_.clear();
  rooms_of_hosts_.assign(situation.map.size(), {});
  for (std::size_t k = 0; k < situation.remote.size(); ++k) {
    std::optional<AuraBox>& all = rooms_of_hosts_[situation.remote[k].host.value];
    const AuraBox& room = outlook.remote_boxes()[k];
    all = all ? joined(*all, room) : room;
  }
}

/// Servers whose region, or anything of whom, is near the box; ours left out.
void Neighbourhood::add_around(const AuraBox& box, const Horizon& look, RegionSet& around) const {
  AuraBox wide = box;
  wide.half.array() += look.clearance_m;
  const double low_x = wide.centre.x() - wide.half.x(), high_x = wide.centre.x() + wide.half.x();
  const double low_z = wide.centre.z() - wide.half.z(), high_z = wide.centre.z() + wide.half.z();
  const Rectangle& home = situation_->map.area(situation_->self);
  const bool inside = home.holds(low_x, low_z, high_x, high_z);
  if (!inside)
    for (std::uint16_t k = 0; k < situation_->map.size(); ++k)
      if ((look.away_too || situation_->linked[k]) &&
          situation_->map.area(RegionId{k}).overlaps(low_x, low_z, high_x, high_z))
        around.add(RegionId{k});
  if (outlook_->near_others(wide))
    outlook_->remote_rows().find_each(RoughBox::around(wide), [&](const BoxRows::Hit& hit) {
      const RegionId host = situation_->remote[hit.number].host;
      if (look.away_too || situation_->linked[host.value]) around.add(host);
    });
  around.remove(situation_->self);
}

void Neighbourhood::add_others_near(const AuraBox& box, double clearance_m,
                                    RegionSet& around) const {
  AuraBox wide = box;
  wide.half.array() += clearance_m;
  const double low_x = wide.centre.x() - wide.half.x(), high_x = wide.centre.x() + wide.half.x();
  const double low_z = wide.centre.z() - wide.half.z(), high_z = wide.centre.z() + wide.half.z();
  std::vector<std::uint32_t> found;
  bool searched = false;
  for (std::uint16_t k = 0; k < situation_->map.size(); ++k) {
    const RegionId other{k};
    if (other == situation_->self || around.contains(other)) continue;
    if (situation_->map.area(other).overlaps(low_x, low_z, high_x, high_z)) {
      around.add(other);
      continue;
    }
    // Seldom is anything of a third server so near that one has to look closely.
    if (!rooms_of_hosts_[k] || !rooms_of_hosts_[k]->overlaps(wide)) continue;
    if (!std::exchange(searched, true)) outlook_->remote_rows().find(wide, found);
    if (std::any_of(found.begin(), found.end(),
                    [&](std::uint32_t aura) { return situation_->remote[aura].host == other; }))
      around.add(other);
  }
}

/// Its aura, and its way if it moves.
AuraBox Neighbourhood::room_of(std::uint32_t body, const Horizon& look) const {
  if (outlook_->rests(body)) return outlook_->box(body);
  return joined(outlook_->box(body), way_of(outlook_->body(body), look.onward_s));
}

void Neighbourhood::add_around(Clusters::Number cluster, const Horizon& look,
                               RegionSet& around) const {
  for (const std::uint32_t member : clusters_->members(cluster))
    add_around(room_of(member, look), look, around);
}

const Horizon& Neighbourhood::horizon_of(Clusters::Number cluster) const {
  return clusters_->has_moved(cluster, long_stay_ticks) ? far_around : near_by;
}

std::optional<RegionSet>& Neighbourhood::known_of(Clusters::Number cluster) {
  if (of_cluster_.size() <= cluster) of_cluster_.resize(clusters_->size());
  return of_cluster_[cluster];
}

const RegionSet& Neighbourhood::of(Clusters::Number cluster) {
  std::optional<RegionSet>& known = known_of(cluster);
  if (!known) add_around(cluster, horizon_of(cluster), known.emplace());
  return *known;
}

bool Neighbourhood::is_crowded(Clusters::Number cluster) {
  if (situation_->map.size() < 3) return false;
  // Where at most one other is near the room that holds them all, none needs to be looked for.
  const Horizon& look = horizon_of(cluster);
  rooms_.clear();
  for (const std::uint32_t member : clusters_->members(cluster))
    rooms_.push_back(room_of(member, look));
  AuraBox room = rooms_.front();
  for (std::size_t n = 1; n < rooms_.size(); ++n) room = joined(room, rooms_[n]);
  room.half.array() += look.clearance_m;
  RegionSet near;
  for (std::uint16_t k = 0; k < situation_->map.size(); ++k) {
    const RegionId region{k};
    if (region == situation_->self) continue;
    const double low_x = room.centre.x() - room.half.x();
    const double low_z = room.centre.z() - room.half.z();
    const double high_x = room.centre.x() + room.half.x();
    const double high_z = room.centre.z() + room.half.z();
    if (situation_->map.area(region).overlaps(low_x, low_z, high_x, high_z) ||
        (rooms_of_hosts_[k] && rooms_of_hosts_[k]->overlaps(room)))
      near.add(region);
  }
  if (!near.holds_several()) return false;
  std::optional<RegionSet>& known = known_of(cluster);
  if (!known) {
    known.emplace();
    for (const AuraBox& box : rooms_) add_around(box, look, *known);
  }
  return known->holds_several();
}

}  // namespace aureole
