// Whether two bodies overlap, and whether they went through each other, for the oracle that looks
// at all servers.
#pragma once

#include <memory>
#include <vector>

#include "server/experiment/oracles/view/world_view.h"
#include "server/physics/shape_probe.h"
#include "server/worlds/world.h"

namespace aureole {

class BodyShapes {
 public:
  explicit BodyShapes(const WorldDefinition& world);

  float bounding_radius(PrototypeId prototype) const { return radii_[prototype.value]; }
  /// Distance between the real shapes (m), infinite when they are not near; negative: how deep they
  /// overlap.
  double separation(const SeenBody& a, const SeenBody& b) const;
  /// Whether the two overlap by more than the slop somewhere on their straight ways.
  bool meet_between(const SeenBody& a_from, const SeenBody& a_to, const SeenBody& b_from,
                    const SeenBody& b_to, double slop_m) const;
  /// Whether one server that had both would see them touch in the step that begins with these
  /// states: it lets Bullet take that step.
  bool collide_in_one_step(const SeenBody& a, const SeenBody& b) const;

 private:
  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> no_statics_;
  std::vector<float> radii_;
  std::unique_ptr<ShapeProbe> probe_;
  std::unique_ptr<PhysicsWorld> physics_;  ///< Only its shapes are used.
};

}  // namespace aureole
