// The published aura projection (Brown, Ushaw and Morgan 2019, sections 3.2 to 4.2) and what it
// cannot do without.
//
// Every body has an aura: a sphere of R_a = R_o + V_t * T_T around it, whatever it does. While the
// aura intersects a boundary it is projected to the other servers (Algorithms 3 to 6). A body whose
// bounding sphere enters an aura of another server migrates there, with everything here whose auras
// overlap, recursively (Algorithm 1). Bodies that have wholly left their host's region go home as
// an island, if none of those whose auras overlap theirs is still inside it (Algorithm 2).
//
// The text leaves some things open without which it does not work; docs/aura-projection.md argues
// for each:
//   - Of two servers whose bodies meet, the one with the higher number hands its cluster over.
//   - A body is also told to the hosts of auras that overlap its own, however deep at home it is.
//   - Islands go home only if no other server's aura touches them, and after half a second.
//   - What is carried goes with its carrier; nothing is told or handed to a server without a link.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"
#include "server/aura/shapes/sphere_grid.h"
#include "server/base/check.h"

namespace aureole {
namespace {

constexpr std::uint32_t no_cluster = static_cast<std::uint32_t>(-1);

class PaperPolicy final : public MigrationPolicy {
 public:
  explicit PaperPolicy(const AuraTolerances& tolerances) : tolerances_(tolerances) {}

  void set_tolerances(const AuraTolerances& tolerances) override { tolerances_ = tolerances; }

  const MigrationDecision& decide(const MigrationSituation& s) override {
    prepare(s);
    meet_others(s);
    decision_.clear();
    std::map<RegionId, std::vector<BodyId>> leaving;
    aura_collisions(s, leaving);
    boundary_traverses(s, leaving);
    for (auto& [to, bodies] : leaving) {
      std::sort(bodies.begin(), bodies.end());
      decision_.leaving.push_back({to, std::move(bodies)});
    }
    project(s, decision_);
    return decision_;
  }

 private:
  struct Body {
    Sphere sphere;  ///< R_o
    Sphere aura;    ///< R_a
    std::uint32_t cluster = no_cluster;
    RegionSet entered;       ///< Hosts of auras that the body itself has entered.
    RegionSet overlapped;    ///< Hosts of auras that overlap its aura.
    RegionId region;         ///< Where its centre is.
    bool traversed = false;  ///< Wholly outside our region.
  };
  /// What one other server projects to us.
  struct Others {
    std::vector<BodyId> ids;
    SphereGrid auras;
  };
  struct Cluster {
    std::vector<std::uint32_t> members;
    bool sent = false;
    bool judged = false;  ///< `checked` of Algorithm 2.
  };

  void prepare(const MigrationSituation& s) {
    AUREOLE_CHECK(s.map.size() <= RegionSet::capacity, "a world has at most 64 regions");
    const Rectangle& home = s.map.area(s.self);
    bodies_.assign(s.hosted.size(), {});
    indices_.clear();
    clusters_.clear();
    std::vector<Sphere> auras;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i) {
      const HostedBody& hosted = s.hosted[i];
      Body& body = bodies_[i];
      body.sphere = {hosted.position.vector(), hosted.bounding_radius_m};
      body.aura = {body.sphere.centre, aura_radius_m(hosted.bounding_radius_m, tolerances_)};
      body.region = s.map.region_at(hosted.position.x, hosted.position.z);
      body.traversed =
          home.distance(hosted.position.x, hosted.position.z) > hosted.bounding_radius_m;
      auras.push_back(body.aura);
      indices_.emplace(hosted.id, i);
    }
    auras_.build(auras);
    followers_.clear();
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i)
      if (const auto leader = index_of(s.hosted[i].leader)) followers_[*leader].push_back(i);
  }

  std::optional<std::uint32_t> index_of(BodyId id) const {
    const auto it = indices_.find(id);
    return it == indices_.end() ? std::nullopt : std::optional(it->second);
  }

  /// Finds out whose projected auras each of our bodies, and each of our auras, touches.
  void meet_others(const MigrationSituation& s) {
    others_.clear();
    std::map<RegionId, std::vector<Sphere>> auras;
    for (const RemoteAura& aura : s.remote) {
      if (index_of(aura.id)) continue;  // Word of a body that has come to us since.
      others_[aura.host].ids.push_back(aura.id);
      auras[aura.host].push_back({aura.room.centre, aura.room.girth_m});
    }
    for (auto& [host, other] : others_) {
      other.auras.build(auras[host]);
      for (Body& body : bodies_) {
        if (!other.auras.any(body.aura)) continue;
        body.overlapped.add(host);
        if (other.auras.any(body.sphere)) body.entered.add(host);
      }
    }
  }

  /// SendWithOverlaps of Algorithm 1 and IslandQuery of Algorithm 2 walk over the same bodies:
  /// recursively those of ours whose auras overlap (GetAuraOverlaps), the first one included. What
  /// is carried hangs together with its carrier.
  Cluster& cluster_of(const MigrationSituation& s, std::uint32_t first) {
    if (bodies_[first].cluster != no_cluster) return clusters_[bodies_[first].cluster];
    const auto number = static_cast<std::uint32_t>(clusters_.size());
    auto& visited = clusters_.emplace_back().members;
    const auto visit = [&](std::uint32_t body) {
      if (bodies_[body].cluster != no_cluster) return;
      bodies_[body].cluster = number;
      visited.push_back(body);
    };
    visit(first);
    for (std::size_t k = 0; k < visited.size(); ++k) {
      const std::uint32_t body = visited[k];
      overlaps_.clear();
      auras_.take(bodies_[body].aura, overlaps_);
      for (const std::uint32_t other : overlaps_) visit(other);
      if (const auto leader = index_of(s.hosted[body].leader)) visit(*leader);
      if (const auto it = followers_.find(body); it != followers_.end())
        for (const std::uint32_t follower : it->second) visit(follower);
    }
    return clusters_[number];
  }

  /// AddToSendBuffer, for a whole cluster.
  void send(const MigrationSituation& s, Cluster& cluster, RegionId to,
            std::map<RegionId, std::vector<BodyId>>& leaving) {
    cluster.sent = true;
    for (const std::uint32_t member : cluster.members) leaving[to].push_back(s.hosted[member].id);
  }

  /// Algorithm 1, AC. To the lowest-numbered of the servers whose auras the cluster has entered:
  /// while things meet, owners change towards lower numbers only, so that nothing can be swapped
  /// or go round in a ring.
  void aura_collisions(const MigrationSituation& s,
                       std::map<RegionId, std::vector<BodyId>>& leaving) {
    std::vector<RegionSet> called(bodies_.size());
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) called[i] = bodies_[i].entered;
    for (const HandoverRequest& request : s.requested)
      if (const auto body = index_of(request.body)) called[*body].add(request.to);
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      if (called[i].empty() || called[i].lowest() >= s.self) continue;
      Cluster& cluster = cluster_of(s, i);
      if (cluster.sent) continue;
      RegionSet hosts;
      for (const std::uint32_t member : cluster.members) hosts.add(called[member]);
      const std::vector<RegionId> to = hosts.regions();
      const auto lowest =
          std::find_if(to.begin(), to.end(), [&](RegionId host) { return s.linked[host.value]; });
      if (lowest != to.end() && *lowest < s.self) send(s, cluster, *lowest, leaving);
    }
  }

  /// Algorithm 2, BT.
  void boundary_traverses(const MigrationSituation& s,
                          std::map<RegionId, std::vector<BodyId>>& leaving) {
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      if (!bodies_[i].traversed) continue;
      Cluster& cluster = cluster_of(s, i);
      if (cluster.sent || cluster.judged) continue;
      cluster.judged = true;
      if (!is_island(s, cluster)) continue;
      const RegionId to = where_most_are(cluster);
      if (to != s.self && s.linked[to.value] && may_leave_for(s, cluster, to))
        send(s, cluster, to, leaving);
    }
  }

  /// IslandQuery: no member overlaps the host's region. Each has to have been here for a while
  /// too, or whatever is met at a boundary would go to and fro.
  bool is_island(const MigrationSituation& s, const Cluster& cluster) const {
    return std::all_of(cluster.members.begin(), cluster.members.end(), [&](std::uint32_t i) {
      return bodies_[i].traversed && s.now - s.hosted[i].changed_owner >= stay_ticks;
    });
  }

  /// The lower number on a tie.
  RegionId where_most_are(const Cluster& cluster) const {
    std::map<RegionId, std::size_t> holds;
    for (const std::uint32_t member : cluster.members) ++holds[bodies_[member].region];
    return std::max_element(holds.begin(), holds.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

  /// Whatever touches an aura of another server may have to be with it in a moment. Only the one
  /// that the island goes to may touch it, and only if that one would never hand its own to us: the
  /// two would pass each other on the way.
  bool may_leave_for(const MigrationSituation& s, const Cluster& cluster, RegionId to) const {
    return std::all_of(cluster.members.begin(), cluster.members.end(), [&](std::uint32_t i) {
      RegionSet others = bodies_[i].overlapped;
      if (to < s.self) others.remove(to);
      return others.empty();
    });
  }

  /// Algorithms 3 to 6: the buffers of auras are the difference that AuraExchange makes of this
  /// set and the last one: new, changed (never of a body that sleeps), and removed.
  void project(const MigrationSituation& s, MigrationDecision& decision) {
    std::map<RegionId, std::set<BodyId>> pulls;
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      const Body& body = bodies_[i];
      if (body.cluster != no_cluster && clusters_[body.cluster].sent) continue;
      const RegionSet audience = audience_of(s.map, s.self, s.hosted[i].position, body.aura.radius);
      RegionSet told = audience;
      told.add(body.overlapped);
      pull(s, body, audience, pulls);
      RegionSet to;
      told.for_each([&](RegionId region) {
        if (s.linked[region.value]) to.add(region);
      });
      if (to.empty()) continue;
      ProjectedAura& aura = decision.projected.emplace_back();
      aura.id = s.hosted[i].id;
      aura.room = {body.aura.centre, {0, 0, 0}, body.aura.radius};
      aura.asleep = s.hosted[i].asleep;
      aura.to = to;
    }
    for (auto& [from, bodies] : pulls)
      decision.pulls.push_back({from, s.self, {bodies.begin(), bodies.end()}});
  }

  /// The higher-numbered server hands over by itself once it knows of the pair. It does not yet if
  /// ours is so deep at home that it was not in its audience: then we ask.
  void pull(const MigrationSituation& s, const Body& body, RegionSet audience,
            std::map<RegionId, std::set<BodyId>>& pulls) {
    for (const RegionId host : body.entered.regions()) {
      if (host < s.self || audience.contains(host) || !s.linked[host.value]) continue;
      Others& others = others_.at(host);
      overlaps_.clear();
      others.auras.take(body.sphere, overlaps_);  // Once is enough.
      for (const std::uint32_t i : overlaps_) pulls[host].insert(others.ids[i]);
    }
  }

  AuraTolerances tolerances_;
  MigrationDecision decision_;
  std::vector<Body> bodies_;  ///< By index in MigrationSituation::hosted.
  SphereGrid auras_;          ///< Ours, less those that are in a cluster already.
  std::map<RegionId, Others> others_;
  std::vector<Cluster> clusters_;
  std::vector<std::uint32_t> overlaps_;  ///< Kept for its room.
  std::unordered_map<BodyId, std::uint32_t> indices_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> followers_;
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_paper_policy(const AuraTolerances& tolerances) {
  return std::make_unique<PaperPolicy>(tolerances);
}

}  // namespace aureole
