// The adaptive mode: what moves must be together, what rests may be cut.
//
// Every body has an aura: the room that it can touch in the time that a decision and a handoff
// take, blows that it may soon take included (outlook.h). A resting body that nothing will strike
// hardly reaches further than its shape. Auras that reach beyond their region are projected to all
// servers that may host something there. Two bodies whose auras overlap must be hosted together
// unless both rest; then each is to the other a wall that does not move, a stand-in.
//
//   - Who gets both is decided by one server (contests.h), so that two can never disagree. Whoever
//     comes near hears of it (visitors.h); what has been given is on its way (promises.h).
//   - With a body goes its cluster (clusters.h).
//   - What nobody holds goes home (homecoming.h).
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "server/aura/adaptive/clusters.h"
#include "server/aura/adaptive/contests/contests.h"
#include "server/aura/adaptive/homecoming.h"
#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/adaptive/visitors.h"
#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

/// How much further than itself an aura is told of.
constexpr double audience_room = 1.5;

/// The same at home. Two boxes that overlap have their centres no further apart than twice the
/// diagonal of the larger one's half: from there it reaches the other's region, even if they meet
/// in a third one.
constexpr double home_audience_room = 3;
static_assert(home_audience_room * home_audience_room > 8);

/// Nothing that happens farther away than this from the boundary and from others' bodies matters
/// there within the reach time (m), but that clusters may reach further. A blow through touching
/// bodies is the fastest thing there is: a ball into a row of ten moves six of them, 3.6 m, in its
/// first step and all ten within five.
constexpr double strip_m = 12;

/// Going home is never urgent.
constexpr std::int64_t homecoming_interval_ticks = 4;

/// How far from its body an aura reaches within the tolerances, 1 m of body included.
double longest_aura_m(const AuraTolerances& tolerances) {
  return tolerances.speed_mps * reach_time_s(tolerances) + 1;
}

class AdaptivePolicy final : public MigrationPolicy {
 public:
  explicit AdaptivePolicy(const AuraTolerances& tolerances)
      : longest_aura_m_(longest_aura_m(tolerances)),
        outlook_(reach_time_s(tolerances)),
        contests_(tolerances) {
    visitors_.set_tolerances(tolerances);
    homecoming_.set_tolerances(tolerances);
  }

  std::int64_t interval_ticks() const override { return decision_ticks; }
  double depth_m() const override { return std::max(strip_m, 2 * longest_aura_m_); }

  void set_tolerances(const AuraTolerances& tolerances) override {
    longest_aura_m_ = longest_aura_m(tolerances);
    outlook_.set_reach(reach_time_s(tolerances));
    contests_.set_tolerances(tolerances);
    visitors_.set_tolerances(tolerances);
    homecoming_.set_tolerances(tolerances);
  }

  const MigrationDecision& decide(const MigrationSituation& s) override {
    decision_.clear();
    outlook_.look(s);
    clusters_.begin(s, outlook_);
    homecoming_.note_unrest(s, outlook_);
    visitors_.begin(s, outlook_);
    contests_.find(s, outlook_, clusters_, visitors_);
    visitors_.warn();
    if (!sees_enough(s)) {
      decision_.sees_too_little = true;
      return decision_;
    }
    Leaving leaving;
    Pulls pulls;
    answer_requests(s, leaving);
    for (const Contests::Verdict& verdict : contests_.verdicts()) {
      for (const Contests::Asked& asked : verdict.asked)
        pulls[{asked.aura->host, verdict.to, asked.known}].insert(asked.aura->id);
      for (const Clusters::Number cluster : verdict.clusters) send(s, cluster, verdict.to, leaving);
    }
    if (s.now - last_homecoming_ >= homecoming_interval_ticks) {
      last_homecoming_ = s.now;
      for (const Homecoming::Pocket& pocket :
           homecoming_.pockets(s, outlook_, clusters_, contests_))
        for (const Clusters::Number cluster : pocket.clusters)
          send(s, cluster, pocket.home, leaving);
    }
    for (auto& [to, bodies] : leaving) {
      std::sort(bodies.begin(), bodies.end());
      decision_.leaving.push_back({to, std::move(bodies)});
    }
    for (const auto& [way, bodies] : pulls) {
      const auto& [from, to, known] = way;
      decision_.pulls.push_back({from, to, {bodies.begin(), bodies.end()}, known});
    }
    visitors_.remember();
    project(s);
    if (s.asks_largest) decision_.largest_cluster = largest_cluster(s);
    return decision_;
  }

 private:
  using Pulls = std::map<std::tuple<RegionId, RegionId, Company::Hold>, std::set<BodyId>>;
  using Leaving = std::map<RegionId, std::vector<BodyId>>;

  /// Whether clusters that may have to go are all shown. Those that go home are: they are outside
  /// of the region.
  bool sees_enough(const MigrationSituation& s) {
    if (s.view == nullptr) return true;
    for (const HandoverRequest& request : s.requested)
      if (const auto body = outlook_.stage().number_of(request.body)) clusters_.of(*body);
    // So far only of what is asked for or meets others' auras is the cluster known.
    for (std::uint32_t i = 0; i < outlook_.size(); ++i) {
      if (!clusters_.known(i)) continue;
      AuraBox reach = outlook_.box(i);
      reach.half.array() += longest_aura_m_;
      if (!s.view->shows(reach)) return false;
    }
    return true;
  }

  /// Of all that is shown and does not rest, whether it meets anything of others or not.
  std::size_t largest_cluster(const MigrationSituation& s) {
    std::size_t most = 0;
    for (std::uint32_t i = 0; i < s.hosted.size(); ++i)
      if (!outlook_.rests(i)) most = std::max(most, clusters_.members(clusters_.of(i)).size());
    return most;
  }

  void send(const MigrationSituation& s, Clusters::Number cluster, RegionId to, Leaving& leaving) {
    if (clusters_.sent(cluster) || to == s.self || !s.linked[to.value]) return;
    clusters_.note_sent(cluster);
    visitors_.note_leaving(clusters_.members(cluster), to);
    for (std::uint32_t member : clusters_.members(cluster))
      leaving[to].push_back(outlook_.body(member).id);
  }

  void answer_requests(const MigrationSituation& s, Leaving& leaving) {
    for (const HandoverRequest& request : s.requested) {
      const auto body = outlook_.stage().number_of(request.body);
      if (!body) continue;
      // Who asks does not see all of the cluster: it may reach where it would be fetched on to.
      const Clusters::Number cluster = clusters_.of(*body);
      if (contests_.is_held_back(cluster, request.body, request.known)) continue;
      const RegionId first = contests_.first_around(cluster);
      send(s, cluster, first == s.self ? request.to : s.order.first(request.to, first), leaving);
    }
  }

  /// Who hears of an aura that is not inside our region, whatever is near to it. Of what is abroad,
  /// and where three regions meet, all who may have something there. Elsewhere, of what is at home,
  /// those whom it may meet at their home, and whoever may be handed what it meets: others come
  /// abroad to meet it, and tell us of what does.
  RegionSet audience(const MigrationSituation& s, const AuraBox& box) const {
    const WorldPosition centre = WorldPosition::from(box.centre);
    const double reach_m = std::max(box.half.x(), box.half.z());
    if (s.map.has_corners() || !s.map.area(s.self).contains(centre.x, centre.z))
      return audience_of(s.map, s.self, centre, audience_room * reach_m + s.map_margin_m);
    RegionSet told =
        audience_at_home(s.map, s.self, centre, home_audience_room * reach_m + s.map_margin_m);
    contests_.neighbourhood().add_others_near(box, home_audience_m, told);
    return told;
  }

  /// Tells of each aura its audience, and the hosts of auras near it. Some room beyond the aura, so
  /// that whoever is about to be met has heard of it.
  void project(const MigrationSituation& s) {
    const Rectangle home = s.map.area(s.self).inner(s.map_margin_m);
    for (const std::uint32_t i : outlook_.stage().ascending()) {
      const auto cluster = clusters_.known(i);
      if (cluster && clusters_.sent(*cluster)) continue;
      const AuraBox& box = outlook_.box(i);
      const RegionSet visitors = visitors_.of(i);
      RegionSet told = visitors;
      if (!home.holds(footprint(box))) told.add(audience(s, box));
      told.remove(s.self);
      if (told.empty()) continue;
      ProjectedAura& aura = decision_.projected.emplace_back();
      aura.id = outlook_.body(i).id;
      aura.room = outlook_.aura(i);
      aura.asleep = outlook_.stage().is_asleep(i);
      aura.resting = outlook_.rests(i);
      aura.speed_mps = outlook_.expected_mps(i);
      if (!visitors.empty()) aura.company = contests_.company_of(i);
      aura.to = told;
    }
  }

  double longest_aura_m_;
  Outlook outlook_;
  Clusters clusters_;
  Contests contests_;
  Visitors visitors_;
  Homecoming homecoming_;
  MigrationDecision decision_;
  Tick last_homecoming_{-homecoming_interval_ticks};
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_adaptive_policy(const AuraTolerances& tolerances) {
  return std::make_unique<AdaptivePolicy>(tolerances);
}

}  // namespace aureole
