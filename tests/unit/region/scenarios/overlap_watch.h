// Looks at all servers of a cluster at once: bodies of different servers that are in each other.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "server/physics/shape_probe.h"
#include "tests/support/region_cluster.h"

namespace aureole::testing {

/// Nobody on either server feels such an overlap: it is the interaction that was missed. By real
/// shapes, for awake bodies; heaps that were cut at rest may have sunk into each other before.
class OverlapWatch {
 public:
  /// What two bodies may overlap by and still count as touching (m).
  static constexpr double slop_m = 0.03;

  explicit OverlapWatch(const WorldDefinition& world) : definitions_(definitions_of(world)) {}

  /// Call after each step, at which all servers are at the same tick.
  void look(RegionCluster& cluster, const WorldDefinition& world) {
    seen_.clear();
    for (int i = 0; i < static_cast<int>(world.regions.size()); ++i)
      for (const NewBody& body : cluster.core(i).physics().awake()) seen_.push_back({body, i});
    for (std::size_t a = 0; a < seen_.size(); ++a)
      for (std::size_t b = a + 1; b < seen_.size(); ++b)
        if (seen_[a].server != seen_[b].server) look_at(seen_[a], seen_[b], cluster.now());
  }
  /// Pairs, as often as they were seen deeper than the slop in each other.
  int overlaps() const { return overlaps_; }
  /// How many pairs were near enough to be measured: 0 says nothing.
  int measured() const { return measured_; }
  double deepest_m() const { return deepest_m_; }
  /// The deepest, for people.
  const std::string& worst() const { return worst_; }

 private:
  struct Seen {
    NewBody body;
    int server;
  };
  static std::vector<BodyDefinition> definitions_of(const WorldDefinition& world) {
    std::vector<BodyDefinition> all;
    for (const Prototype& prototype : world.prototypes) all.push_back(prototype.body);
    return all;
  }
  double radius(const NewBody& body) const {
    return double{bounding_radius(definitions_[body.prototype.value].shape)};
  }
  void look_at(const Seen& a, const Seen& b, Tick now) {
    const double apart = distance(a.body.state.position, b.body.state.position);
    if (apart > radius(a.body) + radius(b.body)) return;
    ++measured_;
    const double depth =
        -double{probe_.separation(a.body.prototype, a.body.state, b.body.prototype, b.body.state)};
    if (depth > slop_m) ++overlaps_;
    if (depth <= deepest_m_) return;
    deepest_m_ = depth;
    worst_ = std::to_string(a.body.id.value) + " of server " + std::to_string(a.server) + " and " +
             std::to_string(b.body.id.value) + " of server " + std::to_string(b.server) +
             " at tick " + std::to_string(now.value) + ": " + std::to_string(depth * 1e3) + " mm";
  }

  std::vector<BodyDefinition> definitions_;
  ShapeProbe probe_{definitions_};
  std::vector<Seen> seen_;
  int overlaps_ = 0, measured_ = 0;
  double deepest_m_ = -std::numeric_limits<double>::infinity();
  std::string worst_;
};

}  // namespace aureole::testing
