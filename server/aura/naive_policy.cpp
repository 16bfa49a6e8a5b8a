// The naive approach of section 3.1: hand over on crossing.
#include <algorithm>
#include <map>
#include <unordered_map>

#include "server/aura/migration_policy.h"

namespace aureole {
namespace {

class NaivePolicy final : public MigrationPolicy {
 public:
  const MigrationDecision& decide(const MigrationSituation& s) override {
    const Rectangle& home = s.map.area(s.self);
    std::map<RegionId, std::vector<BodyId>> leaving;
    std::unordered_map<BodyId, RegionId> leaders;
    for (const HostedBody& body : s.hosted) {
      if (body.leader != BodyId{}) continue;
      if (home.distance(body.position.x, body.position.z) <= naive_hysteresis_m) continue;
      if (s.now - body.changed_owner < stay_ticks) continue;
      const RegionId to = s.map.region_at(body.position.x, body.position.z);
      if (to == s.self || !s.linked[to.value]) continue;
      leaving[to].push_back(body.id);
      leaders.emplace(body.id, to);
    }
    for (const HostedBody& body : s.hosted) {
      if (body.leader == BodyId{}) continue;
      if (auto it = leaders.find(body.leader); it != leaders.end())
        leaving[it->second].push_back(body.id);
    }
    decision_.clear();
    for (auto& [to, bodies] : leaving) {
      std::sort(bodies.begin(), bodies.end());
      decision_.leaving.push_back({to, std::move(bodies)});
    }
    return decision_;
  }

 private:
  MigrationDecision decision_;
};

}  // namespace

std::unique_ptr<MigrationPolicy> make_naive_policy() {
  return std::make_unique<NaivePolicy>();
}

}  // namespace aureole
