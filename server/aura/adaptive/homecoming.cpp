// Islands, and what holds them back.
#include "server/aura/adaptive/homecoming.h"

#include <algorithm>
#include <map>

#include "server/aura/adaptive/aura_size.h"
#include "server/aura/adaptive/contests.h"

namespace aureole {
namespace {

/// Air that an island needs around it before it goes home (m); more than an aura is rounded by.
constexpr double island_clearance_m = 0.1;

/// How far from anything that moves, and from its way of the next second, a resting body must be
/// before it goes home (m).
constexpr double calm_clearance_m = 1.0;

/// Whoever has moved or expected a blow stays where it is for so long before it counts as resting
/// for good and goes home.
constexpr std::int64_t quiet_ticks = 32;

}  // namespace

void Homecoming::note_unrest(const MigrationSituation& s, Outlook& outlook) {
  // Both ascend: one walk finds when each last stirred.
  before_.swap(unrest_);
  unrest_.clear();
  auto known = before_.begin();
  // Who sleeps where nothing comes near to it is not on the stage.
  const auto keep = [&](const std::pair<BodyId, Tick>& entry) {
    if (s.now - entry.second <= quiet_ticks && s.sleepers != nullptr &&
        s.sleepers->place_of(entry.first))
      unrest_.push_back(entry);
  };
  for (const std::uint32_t i : outlook.stage().ascending()) {
    const BodyId id = outlook.body(i).id;
    while (known != before_.end() && known->first < id) keep(*known++);
    const bool is_known = known != before_.end() && known->first == id;
    if (!outlook.rests(i))
      unrest_.emplace_back(id, s.now);
    else if (is_known && s.now - known->second <= quiet_ticks)
      unrest_.push_back(*known);
    if (is_known) ++known;
  }
  while (known != before_.end()) keep(*known++);
  nothing_moves_ =
      unrest_.empty() && std::all_of(s.remote.begin(), s.remote.end(),
                                     [](const RemoteAura& aura) { return aura.resting; });
}

/// Whether a body has moved or expected a blow lately.
bool Homecoming::stirs(BodyId id) const {
  const auto at = std::lower_bound(unrest_.begin(), unrest_.end(), id,
                                   [](const auto& entry, BodyId key) { return entry.first < key; });
  return at != unrest_.end() && at->first == id;
}

bool Homecoming::is_away(std::uint32_t body) const {
  const WorldPosition& at = outlook_->body(body).position;
  return situation_->map.area(situation_->self).distance(at.x, at.z) >
         (outlook_->rests(body) ? resting_hysteresis_m : home_hysteresis_m);
}

/// Where everything that moves may be within the next second if nothing turns it.
void Homecoming::find_threats() {
  threats_.clear();
  threat_bodies_.clear();
  for (std::uint32_t i = 0; i < outlook_->size(); ++i) {
    if (outlook_->rests(i)) continue;
    threats_.push_back(outlook_->box(i));
    if (outlook_->moves(i)) threats_.push_back(way_of(outlook_->body(i), clear_flight_s));
    threat_bodies_.resize(threats_.size(), i);
  }
  for (const RemoteAura& aura : situation_->remote) {
    if (aura.resting) continue;
    threats_.push_back(aura.room.box());
    threats_.back().half.array() += aura.speed_mps * clear_flight_s;
  }
  threat_bodies_.resize(threats_.size(), others_body);
  threat_rows_.build(threats_);
  calm_.clear();
  threats_known_ = true;
}

/// Whether nothing that moves is near the body, nor near anything that it leans on through others
/// that rest: a heap or a row is cut where it has come to rest, not where the next blow is about to
/// fall.
bool Homecoming::is_calm(std::uint32_t body) {
  if (!threats_known_) find_threats();
  calm_.resize(outlook_->size(), Calm::unknown);
  if (calm_[body] != Calm::unknown) return calm_[body] == Calm::calm;
  Calm found_out = Calm::calm;
  std::vector<std::uint32_t> heap{body}, found;
  calm_[body] = Calm::calm;
  for (std::size_t k = 0; k < heap.size() && found_out == Calm::calm; ++k) {
    AuraBox box = outlook_->box(heap[k]);
    found.clear();
    outlook_->find(box, found);
    calm_.resize(outlook_->size(), Calm::unknown);
    for (std::uint32_t other : found) {
      if (!outlook_->rests(other)) continue;
      if (calm_[other] == Calm::threatened) found_out = Calm::threatened;
      if (calm_[other] != Calm::unknown) continue;
      calm_[other] = Calm::calm;
      heap.push_back(other);
    }
    box.half.array() += calm_clearance_m;
    found.clear();
    threat_rows_.find(box, found);
    if (!found.empty()) found_out = Calm::threatened;
  }
  for (std::uint32_t member : heap) calm_[member] = found_out;
  return found_out == Calm::calm;
}

/// Whether the body alone would let its island leave.
bool Homecoming::may_leave(std::uint32_t i, bool contested) {
  const HostedBody& body = outlook_->body(i);
  // Who goes home may be met there at once, and fetched back.
  const std::int64_t stay = nothing_moves_ ? calm_stay_ticks : long_stay_ticks;
  return is_away(i) && !contested && situation_->now - body.changed_owner >= stay &&
         (!outlook_->rests(i) || (!stirs(body.id) && is_calm(i)));
}

/// The clusters around a body that are not clear of each other. Auras travel rounded outwards: what
/// leaves without some air to spare is met again from its new home, and fetched back at once.
std::set<Clusters::Number> Homecoming::island_of(std::uint32_t body) {
  std::set<Clusters::Number> island{clusters_->of(body)};
  std::vector<Clusters::Number> open(island.begin(), island.end());
  std::vector<std::uint32_t> found;
  while (!open.empty()) {
    const auto span = clusters_->members(open.back());
    const std::vector<std::uint32_t> members(span.begin(), span.end());
    open.pop_back();
    for (std::uint32_t member : members) {
      found.clear();
      outlook_->find_company(member, island_clearance_m, found);
      for (std::uint32_t other : found)
        if (const auto near = clusters_->of(other); island.insert(near).second)
          open.push_back(near);
    }
  }
  return island;
}

/// Whether nothing of the island that moves will soon meet bodies that stay here, or that move, or
/// of servers other than `home`.
bool Homecoming::flies_clear(const std::set<Clusters::Number>& island, RegionId home) {
  if (!threats_known_) find_threats();
  const auto stays_here = [&](std::uint32_t body) {
    const auto cluster = clusters_->known(body);
    return !cluster || !island.contains(*cluster);
  };
  std::vector<std::uint32_t> found;
  for (const Clusters::Number number : island)
    for (std::uint32_t member : clusters_->members(number)) {
      if (outlook_->rests(member)) continue;
      const AuraBox way = way_of(outlook_->body(member), clear_flight_s);
      found.clear();
      outlook_->find(way, found);
      for (std::uint32_t other : found)
        if (stays_here(other)) return false;
      found.clear();
      threat_rows_.find(way, found);
      for (std::uint32_t threat : found) {
        const std::uint32_t other = threat_bodies_[threat];
        if (other == others_body || stays_here(other)) return false;
      }
      found.clear();
      outlook_->remote_rows().find(way, found);
      for (std::uint32_t other : found) {
        const RemoteAura& aura = situation_->remote[other];
        if (aura.host != home || !aura.resting) return false;
      }
    }
  return true;
}

std::vector<Homecoming::Island> Homecoming::islands(const MigrationSituation& s, Outlook& outlook,
                                                    Clusters& clusters, const Contests& contests) {
  situation_ = &s;
  outlook_ = &outlook;
  clusters_ = &clusters;
  threats_known_ = false;
  std::vector<Island> leaving;
  std::vector<bool> judged;
  // Sleepers that come on the stage now lie inside of the region.
  const std::uint32_t shown = outlook.size();
  for (std::uint32_t i = 0; i < shown; ++i) {
    if (!is_away(i)) continue;
    const Clusters::Number own = clusters.of(i);
    judged.resize(clusters.size(), false);
    if (judged[own]) continue;
    const std::set<Clusters::Number> island = island_of(i);
    judged.resize(clusters.size(), false);
    std::map<RegionId, std::size_t> holds;
    bool leaves = true;
    for (const Clusters::Number number : island) {
      judged[number] = true;
      leaves = leaves && !clusters.sent(number);
      for (std::uint32_t member : clusters.members(number)) {
        const WorldPosition& at = outlook.body(member).position;
        leaves = leaves && may_leave(member, contests.is_contested(member));
        ++holds[s.map.region_at(at.x, at.z)];
      }
    }
    if (!leaves) continue;
    // Where most of its bodies are; the lower number on a tie.
    const RegionId home = std::max_element(holds.begin(), holds.end(), [](auto& a, auto& b) {
                            return a.second < b.second;
                          })->first;
    if (flies_clear(island, home)) leaving.push_back({{island.begin(), island.end()}, home});
  }
  return leaving;
}

}  // namespace aureole
