// The adaptive mode: what moves must be together, what rests may be cut.
//
// Every body has an aura: its box grown by what it can move in the time that a decision and a
// handoff take, blows that it may soon take included (outlook.h). A resting body that nothing
// will strike hardly reaches further than its shape. Auras that reach beyond their region are
// projected to all servers that may host something there. Two bodies whose auras overlap must be
// hosted together unless both rest; then each is to the other a wall that does not move, a
// stand-in.
//
//   - Between two servers bodies that must meet always go to the one with the lower number, so that
//     two servers can never disagree and swap them for ever: the higher one sends as soon as it
//     knows, the lower one asks for what the other may not know of.
//   - With a body goes its cluster (clusters.h).
//   - What nobody holds goes home (homecoming.h).
#include <algorithm>
#include <map>
#include <set>

#include "server/aura/adaptive/aura_size.h"
#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/homecoming.h"
#include "server/aura/adaptive/outlook.h"
#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

/// A cluster that has to go somewhere goes to the lowest server that has anything near to it, or on
/// its way: at a corner it would be fetched on to that one soon.
struct Surroundings {
  double clearance_m;
  double onward_s;
};
constexpr Surroundings near_by{1.0, 0.5};
/// Who has changed its owner within the last second goes as far as it may have to at once: it must
/// not change it more than twice.
constexpr Surroundings far_around{4.0, 1.0};

/// How much further than itself an aura is told of.
constexpr double audience_room = 1.5;

class AdaptivePolicy final : public MigrationPolicy {
 public:
  explicit AdaptivePolicy(const AuraTolerances& tolerances) : outlook_(reach_time_s(tolerances)) {}

  void set_tolerances(const AuraTolerances& tolerances) override {
    outlook_.set_reach(reach_time_s(tolerances));
  }

  MigrationDecision decide(const MigrationSituation& s) override {
    outlook_.look(s);
    clusters_.begin(s, outlook_);
    homecoming_.note_unrest(s, outlook_);
    Leaving leaving;
    Pulls pulls;
    answer_requests(s, leaving);
    settle_overlaps(s, leaving, pulls);
    for (const Homecoming::Island& island : homecoming_.islands(s, outlook_, clusters_, contested_))
      for (const Clusters::Number cluster : island.clusters) send(s, cluster, island.home, leaving);
    MigrationDecision decision;
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

  void send(const MigrationSituation& s, Clusters::Number cluster, RegionId to, Leaving& leaving) {
    if (clusters_.sent(cluster) || to == s.self || !s.linked[to.value]) return;
    clusters_.note_sent(cluster);
    for (std::uint32_t member : clusters_.members(cluster))
      leaving[to].push_back(s.hosted[member].id);
  }

  void answer_requests(const MigrationSituation& s, Leaving& leaving) {
    for (const HandoverRequest& request : s.requested) {
      const auto body = index_of(s.hosted, request.body);
      if (!body) continue;
      // Who asks does not see all of the cluster: it may reach where it would be fetched on to.
      const Clusters::Number cluster = clusters_.of(*body);
      const RegionId lowest = lowest_around(s, cluster, {});
      send(s, cluster, lowest < s.self ? std::min(request.to, lowest) : request.to, leaving);
    }
  }

  /// Brings overlapping pairs together of which at least one moves. Owners thus change only towards
  /// lower numbers while things meet, and debris on a corner is not passed around.
  void settle_overlaps(const MigrationSituation& s, Leaving& leaving, Pulls& pulls) {
    std::vector<std::uint32_t> found;
    std::map<Clusters::Number, std::vector<const RemoteAura*>> contested;
    contested_.assign(s.hosted.size(), false);
    visitors_.assign(s.hosted.size(), {});
    for (const RemoteAura& aura : s.remote) {
      if (index_of(s.hosted, aura.id)) continue;  // Word of a body that has come to us since.
      found.clear();
      outlook_.grid().find(aura.box, found);
      for (std::uint32_t body : found) {
        visitors_[body].add(aura.host);
        if (outlook_.rests(body) && aura.resting) continue;
        contested_[body] = true;
        contested[clusters_.of(body)].push_back(&aura);
      }
    }
    warn_visitors(s);
    for (const auto& [cluster, auras] : contested) {
      // Ours is on its way already: the two must not swap.
      if (clusters_.sent(cluster)) continue;
      const RegionId to = lowest_around(s, cluster, auras);
      for (const RemoteAura* aura : auras)
        if (aura->host > s.self) pulls[{aura->host, to}].insert(aura->id);
      send(s, cluster, to, leaving);
    }
  }

  /// Whoever hosts something on the way of what moves here is told of it: it must not come home
  /// into the way.
  void warn_visitors(const MigrationSituation& s) {
    if (s.remote.empty()) return;
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      if (!outlook_.moves(i)) continue;
      found.clear();
      outlook_.remote_grid().find(flight_aura(s.hosted[i], clear_flight_s), found);
      for (std::uint32_t other : found) visitors_[i].add(s.remote[other].host);
    }
  }

  /// All servers around a corner come to the same one.
  RegionId lowest_around(const MigrationSituation& s, Clusters::Number cluster,
                         std::span<const RemoteAura* const> auras) const {
    const Surroundings around =
        clusters_.has_moved(cluster, long_stay_ticks) ? far_around : near_by;
    RegionId lowest = s.self;
    for (std::uint32_t member : clusters_.members(cluster)) {
      lowest = lowest_near(s, outlook_.aura(member), around.clearance_m, lowest);
      if (outlook_.rests(member)) continue;
      const AuraBox way = flight_aura(s.hosted[member], around.onward_s);
      lowest = lowest_near(s, way, around.clearance_m, lowest);
    }
    for (const RemoteAura* aura : auras)
      lowest = lowest_near(s, aura->box, around.clearance_m, lowest);
    return lowest;
  }

  /// The lowest server that has anything near the box, or whose region is near, if it is lower than
  /// `lowest`.
  RegionId lowest_near(const MigrationSituation& s, AuraBox box, double clearance_m,
                       RegionId lowest) const {
    box.half.array() += clearance_m;
    for (std::uint16_t k = 0; k < lowest.value; ++k)
      if (s.linked[k] &&
          s.map.area(RegionId{k})
              .overlaps(box.centre.x() - box.half.x(), box.centre.z() - box.half.z(),
                        box.centre.x() + box.half.x(), box.centre.z() + box.half.z()))
        lowest = RegionId{k};
    std::vector<std::uint32_t> found;
    outlook_.remote_grid().find(box, found);
    for (std::uint32_t near : found) {
      const RegionId host = s.remote[near].host;
      if (host < lowest && s.linked[host.value] && !index_of(s.hosted, s.remote[near].id))
        lowest = host;
    }
    return lowest;
  }

  /// Tells of each aura its audience, and the hosts of auras that overlap it. Some room beyond the
  /// aura, so that whoever is about to be met has heard of it.
  void project(const MigrationSituation& s, MigrationDecision& decision) const {
    const Rectangle& home = s.map.area(s.self);
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      const auto cluster = clusters_.known(i);
      if (cluster && clusters_.sent(*cluster)) continue;
      const AuraBox& box = outlook_.aura(i);
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
      aura.resting = outlook_.rests(i);
      aura.speed_mps = outlook_.expected_mps(i);
      aura.to = told.regions();
    }
  }

  Outlook outlook_;
  Clusters clusters_;
  Homecoming homecoming_;
  std::vector<bool> contested_;      ///< Must be brought together with somebody else's.
  std::vector<RegionSet> visitors_;  ///< Hosts of the auras that overlap each body's.
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_adaptive_policy(const AuraTolerances& tolerances) {
  return std::make_unique<AdaptivePolicy>(tolerances);
}

}  // namespace aureole
