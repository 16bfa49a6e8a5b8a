// What a server of the adaptive mode is shown, put together by hand.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/sleepers.h"
#include "tests/support/catch.h"

namespace aureole::adaptive_scene {

inline constexpr double inf = std::numeric_limits<double>::infinity();

/// Columns 10 m wide, from x = 0 on.
inline PartitionMap columns(int count) {
  std::vector<Rectangle> areas(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (i > 0) areas[i].min_x = 10.0 * static_cast<double>(i);
    if (i + 1 < areas.size()) areas[i].max_x = 10.0 * static_cast<double>(i + 1);
  }
  return PartitionMap(std::move(areas));
}

constexpr BodyId name(int n) {
  return BodyId::world(static_cast<std::uint32_t>(n));
}

inline HostedBody asleep_at(int n, double x, double z = 0) {
  HostedBody body;
  body.id = name(n);
  body.slot = static_cast<std::uint32_t>(n);
  body.position = {x, 1, z};
  body.half_extents = {0.3, 0.3, 0.3};
  body.bounding_radius_m = body.girth_m = 0.3;
  body.asleep = true;
  body.changed_owner = Tick{-1000};
  return body;
}

inline HostedBody awake_at(int n, double x, double z = 0) {
  HostedBody body = asleep_at(n, x, z);
  body.asleep = false;
  return body;
}

/// As another server would project such a body; its cluster is its own.
inline RemoteAura aura(int n, std::uint16_t host, bool asleep, double x, double z = 0) {
  RemoteAura remote;
  remote.id = name(n);
  remote.host = RegionId{host};
  remote.room = {{x, 1, z}, {0, 0, 0}, 0.38};
  remote.asleep = remote.resting = asleep;
  remote.speed_mps = asleep ? 0 : 0.2;
  remote.company.label = static_cast<std::uint16_t>(n + 100);
  return remote;
}

/// Bodies in a row of contacts, by their names.
class Row final : public ContactSource {
 public:
  Row(std::uint32_t first, std::uint32_t last) : first_(first), last_(last) {}
  std::size_t find_touching(std::uint32_t slot, std::vector<std::uint32_t>& found) const override {
    found.clear();
    if (slot > first_ && slot <= last_) found.push_back(slot - 1);
    if (slot >= first_ && slot < last_) found.push_back(slot + 1);
    return found.size();
  }
  std::size_t slots() const override { return 1000; }
  BodyId body_in(std::uint32_t slot) const override { return name(static_cast<int>(slot)); }

 private:
  std::uint32_t first_, last_;
};

/// Everything to the right of `from_x` is shown.
class RightPart final : public View {
 public:
  explicit RightPart(double from_x) : from_x_(from_x) {}
  bool shows(const AuraBox& room) const override {
    return room.centre.x() - room.half.x() >= from_x_;
  }
  bool holds(double x, double) const override { return x >= from_x_; }

 private:
  double from_x_;
};

inline bool is_same(const MigrationDecision& a, const MigrationDecision& b) {
  const auto same = [](const auto& x, const auto& y, auto&& equal) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), equal);
  };
  return a.sees_too_little == b.sees_too_little &&
         same(a.leaving, b.leaving,
              [](const Migration& x, const Migration& y) {
                return x.to == y.to && x.bodies == y.bodies;
              }) &&
         same(a.pulls, b.pulls,
              [](const Pull& x, const Pull& y) {
                return x.from == y.from && x.to == y.to && x.bodies == y.bodies;
              }) &&
         same(a.projected, b.projected, [](const ProjectedAura& x, const ProjectedAura& y) {
           return x.id == y.id && x.resting == y.resting && x.asleep == y.asleep && x.to == y.to &&
                  x.speed_mps == y.speed_mps && x.room.girth_m == y.room.girth_m &&
                  x.company.size_class == y.company.size_class &&
                  x.company.changes == y.company.changes && x.company.crowded == y.company.crowded;
         });
}

struct Scene {
  PartitionMap map = columns(2);
  std::uint16_t self = 0;
  std::vector<HostedBody> hosted;
  std::vector<RemoteAura> remote;
  std::vector<HandoverRequest> requested;
  std::vector<bool> linked = std::vector<bool>(16, true);
  const ContactSource* contacts = nullptr;
  const View* view = nullptr;
  std::vector<double> awake;                         ///< By region.
  std::vector<std::uint16_t> levels, levels_before;  ///< By region; empty: all alike.
  bool asks_largest = false;
  double map_margin_m = 0;

  /// The same with those who sleep, and with whom nothing is to happen, among the hosted bodies or
  /// apart: what comes of it must not depend on it.
  enum class Asleep { among_hosted, apart };
  MigrationDecision decide(MigrationPolicy& policy, Tick now,
                           Asleep asleep = Asleep::among_hosted) const {
    MigrationSituation situation{.now = now,
                                 .self = RegionId{self},
                                 .map = map,
                                 .hosted = hosted,
                                 .remote = remote,
                                 .requested = requested,
                                 .linked = linked,
                                 .contacts = contacts,
                                 .view = view,
                                 .awake = awake,
                                 .order = {levels},
                                 .order_before = {levels_before},
                                 .map_margin_m = map_margin_m,
                                 .asks_largest = asks_largest};
    if (asleep == Asleep::among_hosted) return policy.decide(situation);
    Sleepers sleepers(map.area(RegionId{self}));
    std::vector<HostedBody> shown;
    for (const HostedBody& body : hosted) {
      if (body.asleep) sleepers.put(body);
      if (!body.asleep || body.pressed || body.deed_speed_mps > 0 || body.leader != BodyId{})
        shown.push_back(body);
    }
    sleepers.settle();
    situation.hosted = shown;
    situation.sleepers = &sleepers;
    return policy.decide(situation);
  }
  MigrationDecision decide() const {
    const auto apart = decide(*make_adaptive_policy(AuraTolerances{}), Tick{0}, Asleep::apart);
    const auto decision = decide(*make_adaptive_policy(AuraTolerances{}), Tick{0});
    REQUIRE(is_same(decision, apart));
    return decision;
  }
};

inline std::vector<RegionId> told_of(const MigrationDecision& decision, BodyId id) {
  for (const auto& projected : decision.projected)
    if (projected.id == id) return projected.to.regions();
  return {};
}

inline std::vector<RegionId> regions(std::initializer_list<int> numbers) {
  std::vector<RegionId> all;
  for (int n : numbers) all.push_back(RegionId{static_cast<std::uint16_t>(n)});
  return all;
}

/// Bodies of two servers meet on the left of their boundary, and both have just changed their owner
/// twice.
inline Scene both_changed_twice() {
  Scene scene;
  scene.hosted = {awake_at(0, 9.6)};
  scene.hosted[0].changed_owner = Tick{-3};
  scene.hosted[0].changed_owner_before = Tick{-30};
  scene.remote = {aura(1, 1, false, 10.1)};
  scene.remote[0].company.changes = Company::changes_max;
  return scene;
}

}  // namespace aureole::adaptive_scene
