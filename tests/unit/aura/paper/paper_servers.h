// Servers that play the published aura projection, for its test cases.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "server/aura/migration_policy.h"
#include "tests/support/catch.h"

namespace aureole {

/// Balls of 0.3 m: with the paper's tolerances an aura of 2.86 m. A body enters another's aura
/// below 3.16 m between the centres; auras overlap below 5.72 m.
inline constexpr double enters_m = 3.16, overlaps_m = 5.72;

constexpr BodyId name(char letter) {
  return BodyId::world(static_cast<std::uint32_t>(letter));
}

/// As in Fig. 1: servers 0 and 1 side by side, server 2 below both; they meet in a T at the origin.
inline PartitionMap figure_1() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, inf, inf}});
}

/// Servers that each decide once a tick, over links that take one tick.
struct Servers {
  explicit Servers(PartitionMap areas, MigrationMode mode = MigrationMode::paper)
      : map(std::move(areas)), heard(map.size()), asked(map.size()), linked(map.size(), true) {
    for (std::size_t i = 0; i < map.size(); ++i)
      policies.push_back(make_policy(mode, AuraTolerances{}));
  }

  PartitionMap map;
  std::map<BodyId, HostedBody> bodies;
  std::map<BodyId, int> owner;
  std::map<BodyId, int> changes;
  std::vector<std::unique_ptr<MigrationPolicy>> policies;
  std::vector<std::map<BodyId, RemoteAura>> heard;
  std::vector<std::vector<HandoverRequest>> asked;
  std::vector<bool> linked;
  Tick now{1000};
  /// Of the last step, by server.
  std::vector<MigrationDecision> decisions;

  HostedBody& put(char letter, int server, double x, double z) {
    HostedBody body;
    body.id = name(letter);
    body.position = {x, 0.3, z};
    body.half_extents = {0.3, 0.3, 0.3};
    body.bounding_radius_m = 0.3;
    owner[body.id] = server;
    return bodies[body.id] = body;
  }

  MigrationDecision look(int server) {
    const auto self = static_cast<std::size_t>(server);
    std::vector<HostedBody> hosted;
    for (const auto& [id, body] : bodies)
      if (owner[id] == server) hosted.push_back(body);
    std::vector<RemoteAura> remote;
    for (const auto& [id, aura] : heard[self]) remote.push_back(aura);
    return policies[self]->decide({now, RegionId{static_cast<std::uint16_t>(server)}, map, hosted,
                                   remote, asked[self], linked});
  }

  void step(int ticks = 1) {
    for (int n = 0; n < ticks; ++n) {
      decisions.clear();
      for (std::size_t i = 0; i < map.size(); ++i) decisions.push_back(look(static_cast<int>(i)));
      for (std::size_t i = 0; i < map.size(); ++i) heard[i].clear(), asked[i].clear();
      for (std::size_t i = 0; i < map.size(); ++i) tell(i);
      now = now + 1;
    }
  }

  int owner_of(char letter) { return owner.at(name(letter)); }
  int changes_of(char letter) { return changes[name(letter)]; }
  /// To whom server `server` told of the body in the last step.
  std::vector<int> told(int server, char letter) const {
    std::vector<int> to;
    for (const ProjectedAura& aura : decisions[static_cast<std::size_t>(server)].projected)
      if (aura.id == name(letter))
        aura.to.for_each([&](RegionId region) { to.push_back(region.value); });
    return to;
  }
  bool anything_moves() const {
    return std::any_of(decisions.begin(), decisions.end(),
                       [](const MigrationDecision& d) { return !d.leaving.empty(); });
  }

 private:
  void tell(std::size_t from) {
    const RegionId self{static_cast<std::uint16_t>(from)};
    for (const ProjectedAura& aura : decisions[from].projected)
      aura.to.for_each([&](RegionId to) {
        RemoteAura told;
        told.id = aura.id;
        told.host = self;
        told.room = aura.room;
        told.asleep = aura.asleep;
        heard[to.value].try_emplace(aura.id, told);
      });
    for (const Pull& pull : decisions[from].pulls)
      for (BodyId id : pull.bodies) asked[pull.from.value].push_back({id, self});
    for (const Migration& migration : decisions[from].leaving)
      for (BodyId id : migration.bodies) {
        REQUIRE(owner[id] == static_cast<int>(from));  // Also: nothing leaves twice.
        owner[id] = migration.to.value;
        bodies[id].changed_owner = now;
        ++changes[id];
      }
  }
};

}  // namespace aureole
