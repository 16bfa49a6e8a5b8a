// The adaptive mode: what moves must be together, what rests may be cut.
//
// Every body has an aura: its box grown by what it can move in the time that a decision and a
// handoff take, blows that it may soon take included (blow_forecast.h). A resting body that nothing
// will strike hardly reaches further than its shape. Auras that reach beyond their region are
// projected to all servers that may host something there. Two bodies whose auras overlap must be
// hosted together unless both rest; then each is to the other a wall that does not move, a
// stand-in.
//
//   - Between two servers bodies that must meet always go to the one with the lower number, so that
//     two servers can never disagree and swap them for ever: the higher one sends as soon as it
//     knows, the lower one asks for what the other may not know of.
//   - With a body goes its cluster: everything here whose auras overlap, recursively, so that a
//   move
//     does not tear apart what touches (section 3.4, thrashing). It ends at pairs that rest.
//   - A cluster of which no member reaches into the host's region, and which no projected aura
//     touches, is an island: it goes to the region that holds most of it (section 3.5). What rests
//     goes home body by body.
#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "server/aura/audience.h"
#include "server/aura/aura_size.h"
#include "server/aura/blow_forecast.h"
#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

/// Air that an island needs around it before it goes home (m); more than an aura is rounded by.
constexpr double island_clearance_m = 0.1;

/// A cluster that has to go somewhere goes to the lowest server that has anything this near to it
/// (m): at a corner it would be fetched on to that one soon.
constexpr double corner_clearance_m = 1.0;
/// The same for what lies on the way of something that moves (s).
constexpr double onward_s = 0.5;

/// What moves goes home only if it meets nothing but bodies of its new host for so long (s): it
/// would be fetched back at once, and perhaps on from there.
constexpr double clear_flight_s = 1.0;

/// How much further than itself an aura is told of.
constexpr double audience_room = 1.5;

/// More than word from one server to another and the answer take.
constexpr std::int64_t flights_ticks = 8;

/// How far from anything that moves, and from its way of the next second, a resting body must be
/// before it goes home (m).
constexpr double calm_clearance_m = 1.0;

/// Whoever has moved or expected a blow stays where it is for so long before it counts as resting
/// for good and goes home.
constexpr std::int64_t quiet_ticks = 32;

class AdaptivePolicy final : public MigrationPolicy {
 public:
  explicit AdaptivePolicy(const AuraTolerances& tolerances)
      : reach_s_(reach_time_s(tolerances)), forecast_(reach_s_) {}

  MigrationDecision decide(const MigrationSituation& s) override {
    prepare(s);
    MigrationDecision decision;
    Leaving leaving;
    Pulls pulls;
    answer_requests(s, leaving);
    settle_overlaps(s, leaving, pulls);
    send_home(s, leaving);
    for (auto& [to, bodies] : leaving) {
      std::sort(bodies.begin(), bodies.end());
      decision.leaving.push_back({to, std::move(bodies)});
    }
    for (auto& [way, bodies] : pulls)
      decision.pulls.push_back({way.first, way.second, {bodies.begin(), bodies.end()}});
    project(s, decision);
    return decision;
  }

 private:
  using Pulls = std::map<std::pair<RegionId, RegionId>, std::set<BodyId>>;
  using Leaving = std::map<RegionId, std::vector<BodyId>>;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  struct Cluster {
    std::vector<std::uint32_t> members;
    bool sent = false;
  };

  static bool lies_still(const HostedBody& body) {
    return !body.pressed && body.deed_speed_mps <= 0 &&
           (body.asleep || body.still_ticks >= resting_ticks);
  }
  bool rests(std::uint32_t body) const { return expected_mps_[body] <= 0; }

  AuraBox own_aura(const HostedBody& body) const {
    if (lies_still(body)) return resting_aura(body);
    if (body.deed_speed_mps <= 0) return flight_aura(body, reach_s_);
    return struck_aura(body, std::max(body.surface_speed_mps, body.deed_speed_mps), reach_s_);
  }

  void prepare(const MigrationSituation& s) {
    boxes_.clear();
    moving_mps_.clear();
    for (const HostedBody& body : s.hosted) {
      // What has just stopped may start again: it counts as moving, if only a little.
      moving_mps_.push_back(lies_still(body) ? -1.0
                                             : std::max(body.surface_speed_mps, still_speed_mps));
      boxes_.push_back(own_aura(body));
    }
    grid_.build(boxes_);
    forecast_.compute(s, moving_mps_, boxes_, grid_, expected_mps_, disturbed_);
    bool grown = false;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (s.hosted[i].deed_speed_mps > 0) disturbed_[i] = true;
      if (rests(i) ||
          (!disturbed_[i] && !s.hosted[i].near_geometry && expected_mps_[i] <= moving_mps_[i]))
        continue;
      const double speed = std::max(expected_mps_[i], s.hosted[i].deed_speed_mps);
      boxes_[i] = struck_aura(s.hosted[i], speed, reach_s_);
      grown = true;
    }
    if (grown) grid_.build(boxes_);
    note_unrest(s);
    threats_known_ = false;
    cluster_.assign(s.hosted.size(), none);
    clusters_.clear();
    contested_.assign(s.hosted.size(), false);
    followers_.clear();
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (s.hosted[i].leader == BodyId{}) continue;
      if (const auto leader = index_of(s.hosted, s.hosted[i].leader))
        followers_[*leader].push_back(i);
    }
  }

  void note_unrest(const MigrationSituation& s) {
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i)
      if (!rests(i)) unrest_[s.hosted[i].id] = s.now;
    std::erase_if(unrest_, [&](const auto& entry) { return s.now - entry.second > quiet_ticks; });
    nothing_moves_ =
        unrest_.empty() && std::all_of(s.remote.begin(), s.remote.end(),
                                       [](const RemoteAura& aura) { return aura.resting; });
  }

  /// Index of the cluster that the body belongs to; found when first asked for.
  std::size_t cluster_of(const MigrationSituation& s, std::uint32_t body) {
    if (cluster_[body] != none) return cluster_[body];
    const std::size_t number = clusters_.size();
    auto& members = clusters_.emplace_back().members;
    members.push_back(body);
    cluster_[body] = number;
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < members.size(); ++k) {
      found.clear();
      grid_.find(boxes_[members[k]], found);
      std::erase_if(found, [&](std::uint32_t other) { return rests(members[k]) && rests(other); });
      if (const auto it = followers_.find(members[k]); it != followers_.end())
        found.insert(found.end(), it->second.begin(), it->second.end());
      if (const BodyId leader = s.hosted[members[k]].leader; leader != BodyId{})
        if (const auto at = index_of(s.hosted, leader)) found.push_back(*at);
      for (std::uint32_t other : found) {
        if (cluster_[other] != none) continue;
        cluster_[other] = number;
        members.push_back(other);
      }
    }
    return number;
  }

  void send(const MigrationSituation& s, std::size_t cluster, RegionId to, Leaving& leaving) {
    if (clusters_[cluster].sent || to == s.self || !s.linked[to.value]) return;
    clusters_[cluster].sent = true;
    for (std::uint32_t member : clusters_[cluster].members)
      leaving[to].push_back(s.hosted[member].id);
  }

  void answer_requests(const MigrationSituation& s, Leaving& leaving) {
    for (const HandoverRequest& request : s.requested) {
      const auto body = index_of(s.hosted, request.body);
      // Who asks did not know yet that the others come to this one.
      if (body && !keeps_owner(s, cluster_of(s, *body)))
        send(s, cluster_of(s, *body), request.to, leaving);
    }
  }

  /// Brings overlapping pairs together of which at least one moves. Owners thus change only towards
  /// lower numbers while things meet, and debris on a corner is not passed around.
  void settle_overlaps(const MigrationSituation& s, Leaving& leaving, Pulls& pulls) {
    std::vector<std::uint32_t> found;
    std::map<std::size_t, std::vector<const RemoteAura*>> contested;
    visitors_.assign(s.hosted.size(), {});
    remote_grid_.build(remote_boxes(s));
    for (const RemoteAura& aura : s.remote) {
      if (index_of(s.hosted, aura.id)) continue;  // Word of a body that has come to us since.
      found.clear();
      grid_.find(aura.box, found);
      for (std::uint32_t body : found) {
        visitors_[body].add(aura.host);
        if (rests(body) && aura.resting) continue;
        contested_[body] = true;
        contested[cluster_of(s, body)].push_back(&aura);
      }
    }
    for (const auto& [cluster, auras] : contested) {
      // Ours is on its way already: the two must not swap.
      if (clusters_[cluster].sent) continue;
      RegionSet keepers;
      if (keeps_owner(s, cluster)) keepers.add(s.self);
      for (const RemoteAura* aura : auras)
        if (aura->keeps_owner && s.linked[aura->host.value]) keepers.add(aura->host);
      RegionId to = s.self;
      for (std::uint32_t member : clusters_[cluster].members) {
        to = lowest_near(s, boxes_[member], to);
        if (!rests(member)) to = lowest_near(s, flight_aura(s.hosted[member], onward_s), to);
      }
      for (const RemoteAura* aura : auras) to = lowest_near(s, aura->box, to);
      if (!keepers.empty()) to = keepers.lowest();
      for (const RemoteAura* aura : auras)
        if (aura->host > s.self && aura->host != to) pulls[{aura->host, to}].insert(aura->id);
      // Who has just heard that we keep ours may have sent theirs; who has not asks for ours.
      if (keepers.empty() && to < s.self && keeps_owner(s, cluster, flights_ticks)) continue;
      send(s, cluster, to, leaving);
    }
  }

  /// Until when the body must stay: it has changed its owner twice within a second.
  static Tick keeps_until(const HostedBody& body) {
    if (body.changed_owner - body.previous_change >= keep_ticks) return body.previous_change;
    return std::max(body.previous_change + keep_ticks, body.changed_owner + flights_ticks);
  }
  /// Whether a body of the cluster must stay, or had to `ago` ticks ago.
  bool keeps_owner(const MigrationSituation& s, std::size_t cluster, std::int64_t ago = 0) const {
    const auto& members = clusters_[cluster].members;
    return std::any_of(members.begin(), members.end(), [&](std::uint32_t member) {
      return s.now - ago < keeps_until(s.hosted[member]);
    });
  }

  std::span<const AuraBox> remote_boxes(const MigrationSituation& s) {
    remote_boxes_.clear();
    for (const RemoteAura& aura : s.remote) remote_boxes_.push_back(aura.box);
    return remote_boxes_;
  }

  /// The lowest server that has anything near the box, or whose region is near, if it is lower than
  /// `lowest`. All servers around a corner come to the same one.
  RegionId lowest_near(const MigrationSituation& s, AuraBox box, RegionId lowest) const {
    box.half.array() += corner_clearance_m;
    for (std::uint16_t k = 0; k < lowest.value; ++k)
      if (s.linked[k] &&
          s.map.area(RegionId{k})
              .overlaps(box.centre.x() - box.half.x(), box.centre.z() - box.half.z(),
                        box.centre.x() + box.half.x(), box.centre.z() + box.half.z()))
        lowest = RegionId{k};
    std::vector<std::uint32_t> found;
    remote_grid_.find(box, found);
    for (std::uint32_t near : found) {
      const RegionId host = s.remote[near].host;
      if (host < lowest && s.linked[host.value] && !index_of(s.hosted, s.remote[near].id))
        lowest = host;
    }
    return lowest;
  }

  /// The clusters around a body that are not clear of each other. Auras travel rounded outwards:
  /// what leaves without some air to spare is met again from its new home, and fetched back at
  /// once.
  std::set<std::size_t> island_of(const MigrationSituation& s, std::uint32_t body) {
    std::set<std::size_t> island{cluster_of(s, body)};
    std::vector<std::size_t> open(island.begin(), island.end());
    std::vector<std::uint32_t> found;
    while (!open.empty()) {
      const std::size_t number = open.back();
      open.pop_back();
      const std::vector<std::uint32_t> members = clusters_[number].members;
      for (std::uint32_t member : members) {
        AuraBox box = boxes_[member];
        box.half.array() += island_clearance_m;
        found.clear();
        grid_.find(box, found);
        for (std::uint32_t other : found) {
          if (rests(member) && rests(other)) continue;
          if (const std::size_t near = cluster_of(s, other); island.insert(near).second)
            open.push_back(near);
        }
      }
    }
    return island;
  }

  bool is_away(const MigrationSituation& s, std::uint32_t body) const {
    const WorldPosition& at = s.hosted[body].position;
    return s.map.area(s.self).distance(at.x, at.z) >
           (rests(body) ? resting_hysteresis_m : home_hysteresis_m);
  }

  /// Whether nothing that moves is near: a heap is cut where it has come to rest, not where the
  /// next blow is about to fall.
  bool is_calm(const MigrationSituation& s, std::uint32_t body) {
    AuraBox box = boxes_[body];
    box.half.array() += calm_clearance_m;
    if (!threats_known_) find_threats(s);
    std::vector<std::uint32_t> found;
    threat_grid_.find(box, found);
    return found.empty();
  }

  /// Where everything that moves may be within the next second if nothing turns it.
  void find_threats(const MigrationSituation& s) {
    threats_.clear();
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (rests(i)) continue;
      threats_.push_back(boxes_[i]);
      if (moving_mps_[i] > 0) threats_.push_back(flight_aura(s.hosted[i], clear_flight_s));
    }
    for (const RemoteAura& aura : s.remote) {
      if (aura.resting) continue;
      threats_.push_back(aura.box);
      threats_.back().half.array() += aura.speed_mps * clear_flight_s;
    }
    threat_grid_.build(threats_);
    threats_known_ = true;
  }

  /// Whether the body alone would let its island leave.
  bool may_leave(const MigrationSituation& s, std::uint32_t i) {
    const HostedBody& body = s.hosted[i];
    // Who goes home may be met there at once, and fetched back.
    const std::int64_t stay = nothing_moves_ ? calm_stay_ticks : long_stay_ticks;
    return is_away(s, i) && !contested_[i] && s.now - body.changed_owner >= stay &&
           (!rests(i) || (!unrest_.contains(body.id) && is_calm(s, i)));
  }

  void send_home(const MigrationSituation& s, Leaving& leaving) {
    std::vector<bool> judged;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (!is_away(s, i)) continue;
      const std::size_t own = cluster_of(s, i);
      judged.resize(clusters_.size(), false);
      if (judged[own]) continue;
      const std::set<std::size_t> island = island_of(s, i);
      judged.resize(clusters_.size(), false);
      std::map<RegionId, std::size_t> holds;
      bool leaves = true;
      for (std::size_t number : island) {
        judged[number] = true;
        leaves = leaves && !clusters_[number].sent;
        for (std::uint32_t member : clusters_[number].members) {
          const HostedBody& body = s.hosted[member];
          leaves = leaves && may_leave(s, member);
          ++holds[s.map.region_at(body.position.x, body.position.z)];
        }
      }
      if (!leaves) continue;
      // Where most of its bodies are; the lower number on a tie.
      const auto most = std::max_element(holds.begin(), holds.end(),
                                         [](auto& a, auto& b) { return a.second < b.second; });
      if (!flies_clear(s, island, most->first)) continue;
      for (std::size_t number : island) send(s, number, most->first, leaving);
    }
  }

  /// Whether nothing of the island that moves will soon meet bodies that stay here, or that move,
  /// or of servers other than `home`.
  bool flies_clear(const MigrationSituation& s, const std::set<std::size_t>& island,
                   RegionId home) const {
    std::vector<std::uint32_t> found;
    for (std::size_t number : island)
      for (std::uint32_t member : clusters_[number].members) {
        if (rests(member)) continue;
        AuraBox way = flight_aura(s.hosted[member], clear_flight_s);
        found.clear();
        grid_.find(way, found);
        for (std::uint32_t other : found)
          if (cluster_[other] == none || !island.contains(cluster_[other])) return false;
        found.clear();
        remote_grid_.find(way, found);
        for (std::uint32_t other : found)
          if (s.remote[other].host != home || !s.remote[other].resting) return false;
      }
    return true;
  }

  /// Tells of each aura its audience, and the hosts of auras that overlap it. Some room beyond the
  /// aura, so that whoever is about to be met has heard of it.
  void project(const MigrationSituation& s, MigrationDecision& decision) const {
    const Rectangle& home = s.map.area(s.self);
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (cluster_[i] != none && clusters_[cluster_[i]].sent) continue;
      const AuraBox& box = boxes_[i];
      RegionSet told = visitors_[i];
      const bool inside = box.centre.x() - box.half.x() >= home.min_x &&
                          box.centre.x() + box.half.x() < home.max_x &&
                          box.centre.z() - box.half.z() >= home.min_z &&
                          box.centre.z() + box.half.z() < home.max_z;
      if (!inside)
        told.add(audience_of(s.map, s.self, WorldPosition::from(box.centre),
                             audience_room * std::max(box.half.x(), box.half.z())));
      told.remove(s.self);
      if (told.empty()) continue;
      ProjectedAura& aura = decision.projected.emplace_back();
      aura.id = s.hosted[i].id;
      aura.box = box;
      aura.asleep = s.hosted[i].asleep;
      aura.resting = rests(i);
      aura.speed_mps = expected_mps_[i];
      aura.keeps_owner =
          cluster_[i] != none ? keeps_owner(s, cluster_[i]) : s.now < keeps_until(s.hosted[i]);
      aura.to = told.regions();
    }
  }

  double reach_s_;
  std::vector<AuraBox> boxes_;
  std::vector<double> moving_mps_;    ///< Of each body by itself; negative: it lies still.
  std::vector<bool> disturbed_;       ///< Meets something on its way.
  std::vector<double> expected_mps_;  ///< With the blows that it may take; 0: it rests.
  OverlapGrid grid_;
  OverlapGrid remote_grid_;  ///< Of others' auras.
  std::vector<AuraBox> remote_boxes_;
  OverlapGrid threat_grid_;  ///< Built when asked for.
  std::vector<AuraBox> threats_;
  bool threats_known_ = false;
  BlowForecast forecast_;
  std::vector<std::size_t> cluster_;
  std::vector<Cluster> clusters_;
  std::vector<bool> contested_;
  std::vector<RegionSet> visitors_;  ///< Hosts of the auras that overlap each body's.
  std::map<std::uint32_t, std::vector<std::uint32_t>> followers_;
  bool nothing_moves_ = false;               ///< Here for quiet_ticks, nor what others project.
  std::unordered_map<BodyId, Tick> unrest_;  ///< When each body last moved or expected a blow.
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_adaptive_policy(const AuraTolerances& tolerances) {
  return std::make_unique<AdaptivePolicy>(tolerances);
}

}  // namespace aureole
