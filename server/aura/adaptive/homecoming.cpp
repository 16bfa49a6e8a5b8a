// Pockets, and what holds them back.
#include "server/aura/adaptive/homecoming.h"

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <map>

#include "server/aura/adaptive/contests/contests.h"
#include "server/aura/adaptive/contests/load_balance.h"
#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {
namespace {

/// How near things come before they count as meeting (m): auras travel rounded outwards, and what
/// leaves with less air around it would be met again from its new home, and fetched back at once.
constexpr double clearance_m = 0.3;

/// How far ahead (s). Whoever is met later than this at its new home has to come there, or be
/// fetched back: one more change of owner, with all that may go wrong with one. Looking further
/// ahead keeps what creeps about in a layer of bodies abroad for ever.
constexpr double ahead_s = 0.5;

/// What is faster (m/s) may be felt through a heap. Slower things creep about all over a layer of
/// bodies; what rests would never go home there.
constexpr double fast_mps = 1.0;

/// What is no further from the ground stands on it (m).
constexpr double stands_m = 0.03;

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

/// The region that it lies in; or its host's, if that has less to do and it lies near to it.
RegionId Homecoming::belongs_to(std::uint32_t body) const {
  const WorldPosition& at = outlook_->body(body).position;
  const RegionId host = situation_->self, here = situation_->map.region_at(at.x, at.z);
  const std::span<const double> awake = situation_->awake;
  if (here == host || awake.empty()) return here;
  const double kept_m = line_shift_m({awake[here.value], 0}, {awake[host.value], 0});
  return situation_->map.area(host).distance(at.x, at.z) < kept_m ? host : here;
}

bool Homecoming::is_away(std::uint32_t body) const {
  const WorldPosition& at = outlook_->body(body).position;
  return situation_->map.area(situation_->self).distance(at.x, at.z) >
             (outlook_->rests(body) ? resting_hysteresis_m : home_hysteresis_m) &&
         belongs_to(body) != situation_->self;
}

/// Room for what it may do soon if nothing turns it.
AuraBox Homecoming::room_of(std::uint32_t body) const {
  const AuraBox& aura = outlook_->box(body);
  return outlook_->moves(body) ? joined(aura, way_of(outlook_->body(body), ahead_s)) : aura;
}

AuraBox Homecoming::room_of(const RemoteAura& aura, double duration_s) {
  AuraBox room = aura.room.box();
  room.half.array() += aura.speed_mps * duration_s;
  return room;
}

/// Where everything that does not rest may soon be. Whoever comes on the stage meanwhile rests.
const BoxRows& Homecoming::stirrer_rows() {
  if (std::exchange(stirrers_known_, true)) return stirrer_rows_;
  stirrers_.clear();
  rooms_.clear();
  for (std::uint32_t i = 0; i < outlook_->size(); ++i) {
    if (outlook_->rests(i)) continue;
    stirrers_.push_back({.ours = i});
    rooms_.push_back(room_of(i));
  }
  for (const RemoteAura& aura : situation_->remote) {
    if (aura.resting) continue;
    stirrers_.push_back({.other = &aura});
    rooms_.push_back(room_of(aura, ahead_s));
  }
  stirrer_rows_.build(rooms_);
  return stirrer_rows_;
}

/// Where what is fast may strike.
const BoxRows& Homecoming::blow_rows() {
  if (std::exchange(blows_known_, true)) return blow_rows_;
  rooms_.clear();
  for (std::uint32_t i = 0; i < outlook_->size(); ++i)
    if (outlook_->moves(i) && outlook_->body(i).motion_speed_mps > fast_mps)
      rooms_.push_back(joined(outlook_->box(i), way_of(outlook_->body(i), clear_flight_s)));
  for (const RemoteAura& aura : situation_->remote)
    if (!aura.resting && aura.speed_mps > fast_mps) rooms_.push_back(room_of(aura, clear_flight_s));
  blow_rows_.build(rooms_);
  return blow_rows_;
}

/// Whether two that rest and are near each other may carry each other. What stands on the ground
/// carries itself.
bool Homecoming::may_lean(std::uint32_t a, std::uint32_t b) const {
  const auto stands = [&](std::uint32_t body) {
    return outlook_->body(body).ground_gap_m < stands_m;
  };
  return !stands(a) || !stands(b);
}

/// Whether something soon stirs what the body leans on, through others that rest: a heap is cut
/// where it has come to rest, not where it still settles or the next blow is about to fall. Fast
/// blows also go through rows of bodies that only touch.
bool Homecoming::is_threatened(std::uint32_t body, Link link) {
  std::vector<Heap>& heaps = heaps_[static_cast<std::size_t>(link)];
  heaps.resize(outlook_->size(), Heap::unknown);
  if (heaps[body] != Heap::unknown) return heaps[body] == Heap::threatened;
  std::vector<std::uint32_t> heap{body}, found;
  heaps[body] = Heap::calm;
  bool threatened = false;
  for (std::size_t k = 0; k < heap.size() && !threatened; ++k) {
    found.clear();
    outlook_->find(outlook_->box(heap[k]), found);
    heaps.resize(outlook_->size(), Heap::unknown);
    for (const std::uint32_t other : found) {
      if (!outlook_->rests(other) || (link == Link::leaning && !may_lean(heap[k], other))) continue;
      threatened = threatened || heaps[other] == Heap::threatened;
      if (heaps[other] != Heap::unknown) continue;
      heaps[other] = Heap::calm;
      heap.push_back(other);
    }
    // Whom one meets that hangs together with nobody comes along, or holds it back.
    if (heap.size() == 1) continue;
    AuraBox room = outlook_->box(heap[k]);
    room.half.array() += clearance_m;
    found.clear();
    (link == Link::leaning ? stirrer_rows() : blow_rows()).find(room, found);
    threatened = threatened || !found.empty();
  }
  if (threatened)
    for (const std::uint32_t member : heap) heaps[member] = Heap::threatened;
  return threatened;
}

/// Whether the body alone would let its pocket leave.
bool Homecoming::may_leave(std::uint32_t i, bool contested) {
  const HostedBody& body = outlook_->body(i);
  // Who goes home may be met there at once, and fetched back.
  const std::int64_t stay = nothing_moves_ ? calm_stay_ticks : long_stay_ticks;
  // Who was born abroad, where lines have moved, may be met by somebody who has yet to hear of it.
  return is_away(i) && !contested && situation_->now - body.changed_owner >= stay &&
         situation_->now - body.came >= news_ticks_ &&
         (!outlook_->rests(i) || (!stirs(body.id) && !is_threatened(i, Link::leaning) &&
                                  !is_threatened(i, Link::touching)));
}

/// The region that most of the cluster's bodies belong to; the lower number on a tie.
RegionId Homecoming::home_of(Clusters::Number cluster) const {
  const std::span<const std::uint32_t> members = clusters_->members(cluster);
  if (members.size() == 1) return belongs_to(members.front());
  std::map<RegionId, std::size_t> holds;
  for (const std::uint32_t member : members) ++holds[belongs_to(member)];
  return std::max_element(holds.begin(), holds.end(),
                          [](auto& a, auto& b) { return a.second < b.second; })
      ->first;
}

/// Whether another server's body is still met by who goes home: not if a third one hosts it, nor if
/// it comes here meanwhile.
bool Homecoming::is_met_there(const RemoteAura& aura, RegionId home) const {
  return aura.host == home && !contests_->may_come(aura);
}

/// Appends whom the body soon meets here; false if it meets somebody whom it would miss at home.
/// What rests does not meet what rests. The same whichever of two is asked.
bool Homecoming::add_met(std::uint32_t body, RegionId home, std::vector<std::uint32_t>& met) {
  AuraBox room = room_of(body);
  room.half.array() += clearance_m;
  if (!outlook_->rests(body)) {
    outlook_->find(room, met);
    found_.clear();
    outlook_->remote_rows().find(room, found_);
    for (const std::uint32_t other : found_)
      if (!is_met_there(situation_->remote[other], home)) return false;
  }
  found_.clear();
  stirrer_rows().find(room, found_);
  for (const std::uint32_t stirrer : found_) {
    const auto& [ours, other] = stirrers_[stirrer];
    if (other == nullptr)
      met.push_back(ours);
    else if (!is_met_there(*other, home))
      return false;
  }
  return true;
}

/// Whether the cluster could go home if all that it meets came along.
bool Homecoming::look_around(Clusters::Number cluster, RegionId home,
                             std::vector<std::uint32_t>& met) {
  if (clusters_->sent(cluster) || home_of(cluster) != home) return false;
  // A copy: whoever is found may have to come on the stage.
  const auto span = clusters_->members(cluster);
  const boost::container::small_vector<std::uint32_t, 64> members(span.begin(), span.end());
  return std::all_of(members.begin(), members.end(), [&](std::uint32_t member) {
    return may_leave(member, contests_->is_contested(member)) && add_met(member, home, met);
  });
}

std::uint32_t& Homecoming::pocket_at(Clusters::Number cluster) {
  if (judged_.size() <= cluster) judged_.resize(clusters_->size(), no_pocket);
  return judged_[cluster];
}

/// Everything that has to go home together with a cluster; none if it stays. What has been found by
/// then hangs together with it and stays too.
std::vector<Clusters::Number> Homecoming::pocket_of(Clusters::Number first, RegionId home) {
  const std::uint32_t self = ++pockets_;
  std::vector<Clusters::Number> pocket{first};
  pocket_at(first) = self;
  for (std::size_t k = 0; k < pocket.size(); ++k) {
    met_.clear();
    if (!look_around(pocket[k], home, met_)) return {};
    for (const std::uint32_t body : met_) {
      const Clusters::Number cluster = clusters_->of(body);
      std::uint32_t& at = pocket_at(cluster);
      if (at == self) continue;
      if (at != no_pocket) return {};  // It stays.
      at = self;
      pocket.push_back(cluster);
    }
  }
  return pocket;
}

std::vector<Homecoming::Pocket> Homecoming::pockets(const MigrationSituation& s, Outlook& outlook,
                                                    Clusters& clusters, const Contests& contests) {
  situation_ = &s;
  outlook_ = &outlook;
  clusters_ = &clusters;
  contests_ = &contests;
  stirrers_known_ = blows_known_ = false;
  for (std::vector<Heap>& heaps : heaps_) heaps.clear();
  judged_.clear();
  pockets_ = no_pocket;
  std::vector<Pocket> leaving;
  // Sleepers that come on the stage now lie inside of the region.
  const std::uint32_t shown = outlook.size();
  for (std::uint32_t i = 0; i < shown; ++i) {
    if (!is_away(i)) continue;
    const Clusters::Number own = clusters.of(i);
    if (pocket_at(own) != no_pocket) continue;
    const RegionId home = home_of(own);
    Pocket pocket{pocket_of(own, home), home};
    if (!pocket.clusters.empty()) leaving.push_back(std::move(pocket));
  }
  return leaving;
}

}  // namespace aureole
