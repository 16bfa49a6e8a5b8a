// How far two bodies are apart, for the oracle that looks for overlaps.
#pragma once

#include <memory>
#include <vector>

#include "server/experiment/world_view.h"
#include "server/worlds/world.h"

namespace aureole {

/// Spheres and capsules are exact; of any other shape it knows a capsule that lies inside it, so
/// that it never sees an overlap that is none.
class BodyShapes {
 public:
  explicit BodyShapes(const WorldDefinition& world);

  float bounding_radius(PrototypeId prototype) const { return radii_[prototype.value]; }
  /// Distance between the surfaces (m); negative: how deep they overlap.
  double separation(const SeenBody& a, const SeenBody& b) const;
  /// Whether one server that had both would see them touch in the step that begins with these
  /// states: it lets Bullet take that step.
  bool collide_in_one_step(const SeenBody& a, const SeenBody& b) const;

 private:
  struct Capsule {
    Eigen::Vector3f half_axis{0, 0, 0};  ///< From the centre to the middle of a cap.
    float radius = 0;
  };
  static Capsule inscribed(const Shape& shape);

  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> no_statics_;
  std::vector<float> radii_;
  std::vector<Capsule> capsules_;
  std::unique_ptr<PhysicsWorld> physics_;  ///< Only its shapes are used.
};

}  // namespace aureole
