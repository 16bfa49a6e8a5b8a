// Aura projection: what may soon touch is brought together, what has left for good goes home.
//
// Every body has an aura: its box grown by what it can move in the time that a decision and a
// handoff take. Auras that reach beyond their region are projected to all servers that may host
// something there. Where a body of ours overlaps a projected aura, the two must be hosted together:
//
//   - One arbiter decides for each pair of servers, the one with the lower number, so that two
//     servers can never disagree and swap their bodies for ever: it asks the other for its body.
//   - With a body goes its cluster: everything here whose auras overlap, recursively, so that a
//   move
//     does not tear apart what touches (section 3.4, thrashing).
//   - A cluster of which no member reaches into the host's region, and which no projected aura
//     touches, is an island: it goes to the region that holds most of it (section 3.5).
#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

/// Resting bodies reach this much further than their shape (m): two that touch, or nearly, belong
/// together even before they stir.
constexpr double resting_margin_m = 0.08;

/// Air that an island needs around it before it goes home (m); more than an aura is rounded by.
constexpr double island_clearance_m = 0.1;

class AdaptivePolicy final : public MigrationPolicy {
 public:
  explicit AdaptivePolicy(const AuraTolerances& tolerances)
      // A request to the other server takes one more flight than the paper's T_T covers.
      : reach_s_(total_displacement_s(tolerances) + steps_in_flight(tolerances) * (tick_us / 1e6)) {
  }

  MigrationDecision decide(const MigrationSituation& s) override {
    prepare(s);
    MigrationDecision decision;
    std::map<RegionId, std::vector<BodyId>> leaving;
    std::map<RegionId, std::set<BodyId>> pulls;
    answer_requests(s, leaving);
    settle_overlaps(s, pulls);
    send_islands_home(s, leaving);
    for (auto& [to, bodies] : leaving) {
      std::sort(bodies.begin(), bodies.end());
      decision.leaving.push_back({to, std::move(bodies)});
    }
    for (auto& [from, bodies] : pulls)
      decision.pulls.push_back({from, {bodies.begin(), bodies.end()}});
    project(s, decision);
    return decision;
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  struct Cluster {
    std::vector<std::uint32_t> members;
    bool sent = false;
  };

  /// `speed_mps`: the fastest that the body may soon move; negative: it rests.
  AuraBox aura_of(const HostedBody& body, double speed_mps) const {
    AuraBox box{body.position.vector(), body.half_extents};
    double reach = resting_margin_m;
    if (speed_mps >= 0) {
      const double fall = 0.5 * 9.81 * reach_s_ * reach_s_;
      reach += speed_mps * reach_s_ + fall;
    }
    box.half.array() += reach;
    return box;
  }

  /// What may soon be struck may soon move as fast as what strikes it, and then it is too late to
  /// ask whom it meets: its aura grows before the blow.
  void expect_blows(const MigrationSituation& s) {
    std::vector<double> speeds(speeds_);
    std::vector<std::uint32_t> found;
    bool any = false;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (s.hosted[i].asleep) continue;
      found.clear();
      grid_.find(boxes_[i], found);
      for (std::uint32_t other : found) {
        if (speeds[other] >= speeds_[i]) continue;
        speeds[other] = speeds_[i];
        any = true;
      }
    }
    if (!any) return;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i)
      if (speeds[i] > speeds_[i]) boxes_[i] = aura_of(s.hosted[i], speeds[i]);
    grid_.build(boxes_);
  }

  void prepare(const MigrationSituation& s) {
    boxes_.clear();
    speeds_.clear();
    for (const HostedBody& body : s.hosted) {
      speeds_.push_back(body.asleep ? -1 : body.surface_speed_mps);
      boxes_.push_back(aura_of(body, speeds_.back()));
    }
    grid_.build(boxes_);
    expect_blows(s);
    cluster_.assign(s.hosted.size(), none);
    clusters_.clear();
    contested_.assign(s.hosted.size(), false);
    indices_.clear();
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) indices_.emplace(s.hosted[i].id, i);
    followers_.clear();
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i)
      if (const auto it = indices_.find(s.hosted[i].leader); it != indices_.end())
        followers_[it->second].push_back(i);
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
      if (const auto it = followers_.find(members[k]); it != followers_.end())
        found.insert(found.end(), it->second.begin(), it->second.end());
      if (const auto it = indices_.find(s.hosted[members[k]].leader); it != indices_.end())
        found.push_back(it->second);
      for (std::uint32_t other : found) {
        if (cluster_[other] != none) continue;
        cluster_[other] = number;
        members.push_back(other);
      }
    }
    return number;
  }

  void send(const MigrationSituation& s, std::size_t cluster, RegionId to,
            std::map<RegionId, std::vector<BodyId>>& leaving) {
    if (clusters_[cluster].sent || to == s.self || !s.linked[to.value]) return;
    clusters_[cluster].sent = true;
    for (std::uint32_t member : clusters_[cluster].members)
      leaving[to].push_back(s.hosted[member].id);
  }

  void answer_requests(const MigrationSituation& s,
                       std::map<RegionId, std::vector<BodyId>>& leaving) {
    for (const HandoverRequest& request : s.requested)
      if (const auto it = indices_.find(request.body); it != indices_.end())
        send(s, cluster_of(s, it->second), request.to, leaving);
  }

  /// As arbiter, asks for the bodies of others that overlap ours. Owners thus change only towards
  /// lower numbers while things meet, and debris on a corner is not passed around. What moves stays
  /// where it is stepped; what rests is fetched, which disturbs it least.
  void settle_overlaps(const MigrationSituation& s, std::map<RegionId, std::set<BodyId>>& pulls) {
    std::vector<std::uint32_t> found;
    visitors_.assign(s.hosted.size(), {});
    for (const RemoteAura& aura : s.remote) {
      if (indices_.contains(aura.id)) continue;  // Word of a body that has come to us since.
      found.clear();
      grid_.find(aura.box, found);
      for (std::uint32_t body : found) {
        contested_[body] = true;
        visitors_[body].push_back(aura.host);
        // Not ours to decide, or ours is on its way already: the two must not swap.
        if (aura.host < s.self || clusters_[cluster_of(s, body)].sent) continue;
        pulls[aura.host].insert(aura.id);
      }
    }
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
        for (std::uint32_t other : found)
          if (const std::size_t near = cluster_of(s, other); island.insert(near).second)
            open.push_back(near);
      }
    }
    return island;
  }

  void send_islands_home(const MigrationSituation& s,
                         std::map<RegionId, std::vector<BodyId>>& leaving) {
    const Rectangle& home = s.map.area(s.self);
    const auto is_away = [&](std::uint32_t i) {
      const WorldPosition& at = s.hosted[i].position;
      return home.distance(at.x, at.z) > (s.hosted[i].asleep ? 0.0 : home_hysteresis_m);
    };
    std::set<std::size_t> judged;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (!is_away(i) || judged.contains(cluster_of(s, i))) continue;
      const std::set<std::size_t> island = island_of(s, i);
      judged.insert(island.begin(), island.end());
      std::map<RegionId, std::size_t> holds;
      bool leaves = true;
      for (std::size_t number : island) {
        leaves = leaves && !clusters_[number].sent;
        for (std::uint32_t member : clusters_[number].members) {
          const HostedBody& body = s.hosted[member];
          // Who moves may be met again as soon as it is home, and would be back at once.
          const std::int64_t stay = body.asleep ? stay_ticks : 2 * stay_ticks;
          leaves = leaves && is_away(member) && !contested_[member] &&
                   s.now - body.changed_owner >= stay;
          ++holds[s.map.region_at(body.position.x, body.position.z)];
        }
      }
      if (!leaves) continue;
      // Where most of its bodies are; the lower number on a tie.
      const auto most = std::max_element(holds.begin(), holds.end(),
                                         [](auto& a, auto& b) { return a.second < b.second; });
      for (std::size_t number : island) send(s, number, most->first, leaving);
    }
  }

  /// Tells every server that may host something where the aura reaches: the regions it overlaps,
  /// their neighbours (the corner case, section 3.6), and the hosts of auras that overlap it. An
  /// aura beyond our neighbours concerns everybody: another server that hosts as far from its home
  /// would otherwise neither hear of us nor be heard.
  void project(const MigrationSituation& s, MigrationDecision& decision) const {
    const Rectangle& home = s.map.area(s.self);
    const auto& near = s.map.neighbours(s.self);
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (cluster_[i] != none && clusters_[cluster_[i]].sent) continue;
      const AuraBox& box = boxes_[i];
      const bool inside = box.centre.x() - box.half.x() >= home.min_x &&
                          box.centre.x() + box.half.x() < home.max_x &&
                          box.centre.z() - box.half.z() >= home.min_z &&
                          box.centre.z() + box.half.z() < home.max_z;
      std::set<RegionId> to(visitors_[i].begin(), visitors_[i].end());
      if (!inside) {
        const double reach = std::max(box.half.x(), box.half.z());
        for (RegionId region : s.map.regions_within(box.centre.x(), box.centre.z(), 1.5 * reach)) {
          to.insert(region);
          const auto& around = s.map.neighbours(region);
          to.insert(around.begin(), around.end());
          if (region == s.self || std::binary_search(near.begin(), near.end(), region)) continue;
          for (std::size_t k = 0; k < s.map.size(); ++k)
            to.insert(RegionId{static_cast<std::uint16_t>(k)});
        }
      }
      to.erase(s.self);
      if (!to.empty())
        decision.projected.push_back(
            {s.hosted[i].id, box, s.hosted[i].asleep, false, 0, {to.begin(), to.end()}});
    }
  }

  double reach_s_;
  std::vector<AuraBox> boxes_;
  std::vector<double> speeds_;  ///< Of each body by itself (m/s); negative: it rests.
  OverlapGrid grid_;
  std::vector<std::size_t> cluster_;
  std::vector<Cluster> clusters_;
  std::vector<bool> contested_;
  std::vector<std::vector<RegionId>> visitors_;
  std::unordered_map<BodyId, std::uint32_t> indices_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> followers_;
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_adaptive_policy(const AuraTolerances& tolerances) {
  return std::make_unique<AdaptivePolicy>(tolerances);
}

}  // namespace aureole
