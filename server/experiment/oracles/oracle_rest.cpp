// Groups around what is awake are left out, everything else is judged.
#include "server/experiment/oracles/oracle_rest.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/experiment/oracles/oracle_ownership.h"

namespace aureole {
namespace {

constexpr std::size_t told_max = 4;

}  // namespace

RestOracle::RestOracle(const WorldDefinition& world)
    : goes_home_(world.mode == MigrationMode::adaptive) {
  for (const auto& prototype : world.prototypes)
    radii_.push_back(bounding_radius(prototype.body.shape));
}

void RestOracle::gather(std::span<const SimulatedServer> servers) {
  bodies_.clear();
  for (const SimulatedServer& server : servers) {
    if (!server.runs()) continue;
    const PhysicsWorld& physics = server.core().physics();
    const Rectangle& home = server.core().home_lines().map().area(server.self());
    for (BodyId id : physics.ids()) {
      if (id.kind() == BodyId::Kind::avatar) continue;
      const WorldPosition at = physics.position(id);
      bodies_.push_back({id, server.self(), at, home.distance(at.x, at.z),
                         radii_[physics.prototype(id).value], !physics.is_asleep(id)});
    }
  }
}

void RestOracle::leave_out_what_stirs() {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].left_out = bodies_[i].awake;
    if (bodies_[i].awake) open.push_back(i);
  }
  while (!open.empty()) {
    const Body& from = bodies_[open.back()];
    open.pop_back();
    // From what stirs a little further; what hangs together with its neighbours touches.
    const double gap_m = from.awake ? near_m : 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Body& to = bodies_[i];
      if (to.left_out || distance(from.at, to.at) > from.radius_m + to.radius_m + gap_m) continue;
      to.left_out = true;
      open.push_back(i);
    }
  }
}

void RestOracle::judge(Tick now, std::span<const SimulatedServer> servers,
                       std::span<const OwnerChange> late) {
  gather(servers);
  leave_out_what_stirs();
  for (const Body& b : bodies_) {
    awake_ += b.awake ? 1 : 0;
    left_out_ += b.left_out && !b.awake ? 1 : 0;
    if (!goes_home_ || b.left_out || b.away_m <= away_m_max) continue;
    violate(now,
            fmt::format("{} sleeps on r{}, {:.2f} m outside of its region, at ({:.2f}, {:.2f})",
                        describe(b.id), b.owner.value, b.away_m, b.at.x, b.at.z));
  }
  for (const OwnerChange& change : late) {
    const auto it = std::find_if(bodies_.begin(), bodies_.end(),
                                 [&](const Body& b) { return b.id == change.id; });
    if (it != bodies_.end() && it->left_out) continue;
    violate(change.tick,
            fmt::format("{} went from r{} to r{} in the last second although nothing moves near it",
                        describe(change.id), change.from.value, change.to.value));
  }
}

void RestOracle::leave_out_all(std::span<const SimulatedServer> servers) {
  gather(servers);
  for (const Body& b : bodies_) ++(b.awake ? awake_ : left_out_);
}

void RestOracle::violate(Tick tick, std::string what) {
  ++unsettled_;
  if (violations_.size() < told_max)
    violations_.push_back({"unsettled", tick.value, std::move(what)});
}

void RestOracle::report(SeedResult& result) const {
  result.unsettled += unsettled_;
  result.awake_at_end += awake_;
  result.rest_not_judged += left_out_;
  result.violations.insert(result.violations.end(), violations_.begin(), violations_.end());
}

}  // namespace aureole
