// Building Bullet's shapes so that their surfaces lie where the plain description says.
#include "server/physics/bullet/bullet_shapes.h"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>

#include "server/base/check.h"
#include "server/physics/bullet/bullet_conversions.h"

namespace aureole {
namespace {

/// Bullet's collision margin for hulls (unit: m). Wide enough that resting contacts stay in the
/// fast and steady part of GJK, narrow enough that rounded edges cannot be seen.
constexpr float hull_margin_max = 0.04f;
/// A hull may lose at most this share of its inner radius to the margin.
constexpr float hull_shrink_share_max = 0.3f;
/// Margin of a hull that is too thin to be shrunk (unit: m): its surface lies this much outside.
constexpr float thin_hull_margin = 0.005f;

float hull_margin(const ConvexHullShape& s) {
  Eigen::Vector3f low = s.points.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& p : s.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return std::min(hull_margin_max, 0.1f * ((high - low) / 2).minCoeff());
}

}  // namespace

ShapeLibrary::ShapeLibrary(std::span<const BodyDefinition> prototypes,
                           std::span<const StaticDefinition> statics)
    : prototypes_(prototypes),
      statics_(statics),
      built_prototypes_(prototypes.size()),
      built_statics_(statics.size(), nullptr) {}

const ShapeLibrary::Built& ShapeLibrary::prototype(PrototypeId id) {
  AUREOLE_CHECK(id.value < prototypes_.size(), "a body's prototype is in the world's table");
  Built& built = built_prototypes_[id.value];
  if (built.shape) return built;
  const BodyDefinition& definition = prototypes_[id.value];
  AUREOLE_CHECK(!std::holds_alternative<PlaneShape>(definition.shape),
                "only static geometry can be a plane");
  AUREOLE_CHECK(definition.mass_kg > 0, "a body has mass");
  btCollisionShape* shape = build(definition.shape);
  if (!definition.upright) shape->calculateLocalInertia(definition.mass_kg, built.inertia);
  built.shape = shape;
  return built;
}

btCollisionShape* ShapeLibrary::fixed(StaticId id) {
  AUREOLE_CHECK(id.value < statics_.size(), "a static is in the world's table");
  btCollisionShape*& built = built_statics_[id.value];
  if (!built) built = build(statics_[id.value].shape);
  return built;
}

btCollisionShape* ShapeLibrary::build(const Shape& shape) {
  using Variant = Shape::variant;
  return std::visit([this](const auto& s) { return make(s); }, static_cast<const Variant&>(shape));
}

btCollisionShape* ShapeLibrary::keep(std::unique_ptr<btCollisionShape> shape) {
  owned_.push_back(std::move(shape));
  return owned_.back().get();
}

btCollisionShape* ShapeLibrary::make(const SphereShape& s) {
  return keep(std::make_unique<btSphereShape>(s.radius));
}

btCollisionShape* ShapeLibrary::make(const BoxShape& s) {
  return keep(std::make_unique<btBoxShape>(to_bullet(s.half_extents)));
}

btCollisionShape* ShapeLibrary::make(const CapsuleShape& s) {
  // Bullet's height is the distance between the centres of the caps.
  return keep(std::make_unique<btCapsuleShape>(s.radius, std::max(0.f, s.height - 2 * s.radius)));
}

btCollisionShape* ShapeLibrary::make(const CylinderShape& s) {
  return keep(std::make_unique<btCylinderShape>(btVector3(s.radius, s.height / 2, s.radius)));
}

btCollisionShape* ShapeLibrary::make(const ConvexHullShape& s) {
  AUREOLE_CHECK(s.points.size() >= 4, "a hull has at least four points");
  // Bullet puts the margin around the points: move the faces inwards by as much, so that bodies
  // touch where they are drawn.
  btConvexHullComputer computer;
  const float shrunk =
      computer.compute(s.points.front().data(), sizeof(Eigen::Vector3f),
                       static_cast<int>(s.points.size()), hull_margin(s), hull_shrink_share_max);
  auto hull = std::make_unique<btConvexHullShape>();
  if (shrunk > 0 && computer.vertices.size() >= 4) {
    for (int i = 0; i < computer.vertices.size(); ++i) hull->addPoint(computer.vertices[i], false);
    hull->setMargin(shrunk);
  } else {
    for (const Eigen::Vector3f& p : s.points) hull->addPoint(to_bullet(p), false);
    hull->setMargin(thin_hull_margin);
  }
  hull->recalcLocalAabb();
  return keep(std::move(hull));
}

btCollisionShape* ShapeLibrary::make(const CompoundShape& s) {
  AUREOLE_CHECK(!s.children.empty(), "a compound has children");
  auto compound = std::make_unique<btCompoundShape>(true, static_cast<int>(s.children.size()));
  for (const CompoundShape::Child& child : s.children) {
    AUREOLE_CHECK(child.shape && !std::holds_alternative<CompoundShape>(*child.shape) &&
                      !std::holds_alternative<PlaneShape>(*child.shape),
                  "a compound's children are simple shapes");
    compound->addChildShape(btTransform(to_bullet(child.orientation), to_bullet(child.position)),
                            build(*child.shape));
  }
  return keep(std::move(compound));
}

btCollisionShape* ShapeLibrary::make(const PlaneShape&) {
  return keep(std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), 0.f));
}

}  // namespace aureole
