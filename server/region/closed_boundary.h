// While a region is down, its boundary is a wall to its neighbours' bodies.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "server/aura/partition/partition_map.h"
#include "server/base/ids.h"
#include "server/physics/physics_world.h"

namespace aureole {

/// For one physics step. An awake body whose centre is outside of one of the `closed` areas and
/// would be inside it after the step loses the part of its velocity that leads in, and
/// its spin; whatever is pushed in all the same is put back on the edge. Bodies that are already
/// across are let be. Areas may overlap.
class ClosedBoundary {
 public:
  explicit ClosedBoundary(std::vector<Rectangle> closed) : closed_(std::move(closed)) {}

  /// Call before the step of `dt_s` (s) …
  void before_step(PhysicsWorld& physics, float dt_s);
  /// … and after it.
  void after_step(PhysicsWorld& physics) const;

 private:
  std::vector<Rectangle> closed_;
  struct Outside {
    BodyId id;
    std::size_t area;
  };
  std::vector<Outside> outside_;  ///< Who could get across in this step, and where.
};

}  // namespace aureole
