// What a server of the adaptive mode is shown, put together by hand.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "server/aura/migration_policy.h"

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

/// Bodies in a row of contacts, by their places among those hosted.
class Row final : public ContactSource {
 public:
  Row(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t n = first; n <= last; ++n) {
      partners_.resize(n + 1);
      if (n == first) continue;
      partners_[n].push_back(n - 1);
      partners_[n - 1].push_back(n);
    }
  }
  std::span<const std::uint32_t> touching(std::uint32_t body) const override {
    return body < partners_.size() ? std::span(partners_[body]) : std::span<const std::uint32_t>{};
  }
  std::size_t leaning_on(std::uint32_t body) const override { return touching(body).size(); }

 private:
  std::vector<std::vector<std::uint32_t>> partners_;
};

/// Everything to the right of `from_x` is shown.
class RightPart final : public View {
 public:
  explicit RightPart(double from_x) : from_x_(from_x) {}
  bool shows(const AuraBox& room) const override {
    return room.centre.x() - room.half.x() >= from_x_;
  }

 private:
  double from_x_;
};

struct Scene {
  PartitionMap map = columns(2);
  std::uint16_t self = 0;
  std::vector<HostedBody> hosted;
  std::vector<RemoteAura> remote;
  std::vector<HandoverRequest> requested;
  std::vector<bool> linked = std::vector<bool>(16, true);
  const ContactSource* contacts = nullptr;
  const View* view = nullptr;

  MigrationDecision decide(MigrationPolicy& policy, Tick now) const {
    return policy.decide(
        {now, RegionId{self}, map, hosted, remote, requested, linked, contacts, view});
  }
  MigrationDecision decide() const {
    return decide(*make_adaptive_policy(AuraTolerances{}), Tick{0});
  }
};

inline std::vector<RegionId> told_of(const MigrationDecision& decision, BodyId id) {
  for (const auto& projected : decision.projected)
    if (projected.id == id) return projected.to;
  return {};
}

inline std::vector<RegionId> regions(std::initializer_list<int> numbers) {
  std::vector<RegionId> all;
  for (int n : numbers) all.push_back(RegionId{static_cast<std::uint16_t>(n)});
  return all;
}

}  // namespace aureole::adaptive_scene
