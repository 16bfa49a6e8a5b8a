// Regions by their areas, servers by the auras that they project.
#include "server/aura/adaptive/contests/neighbourhood.h"

#include <algorithm>
#include <span>
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
  const Rectangle ground = footprint(wide);
  if (!situation_->map.area(situation_->self).holds(ground))
    for (std::uint16_t k = 0; k < situation_->map.size(); ++k)
      if ((look.away_too || situation_->linked[k]) &&
          situation_->map.area(RegionId{k}).overlaps(ground))
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
  const Rectangle ground = footprint(wide);
  std::vector<std::uint32_t> found;
  bool searched = false;
  for (std::uint16_t k = 0; k < situation_->map.size(); ++k) {
    const RegionId other{k};
    if (other == situation_->self || around.contains(other)) continue;
    if (situation_->map.area(other).overlaps(ground)) {
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

/// Whether several others have their region, or any aura, near the box around all of rooms_. If
/// not, no closer look finds several.
bool Neighbourhood::may_be_crowded(const Horizon& look) const {
  AuraBox all = rooms_.front();
  for (const AuraBox& room : std::span(rooms_).subspan(1)) all = joined(all, room);
  all.half.array() += look.clearance_m;
  const Rectangle ground = footprint(all);
  RegionSet near;
  for (std::uint16_t k = 0; k < situation_->map.size(); ++k) {
    const RegionId region{k};
    if (region == situation_->self) continue;
    if (situation_->map.area(region).overlaps(ground) ||
        (rooms_of_hosts_[k] && rooms_of_hosts_[k]->overlaps(all)))
      near.add(region);
  }
  return near.holds_several();
}

bool Neighbourhood::is_crowded(Clusters::Number cluster) {
  if (situation_->map.size() < 3) return false;
  std::optional<RegionSet>& known = known_of(cluster);
  if (!known) {
    const Horizon& look = horizon_of(cluster);
    rooms_.clear();
    for (const std::uint32_t member : clusters_->members(cluster))
      rooms_.push_back(room_of(member, look));
    if (!may_be_crowded(look)) return false;
    RegionSet& around = known.emplace();
    for (const AuraBox& room : rooms_) add_around(room, look, around);
  }
  return known->holds_several();
}

}  // namespace aureole
