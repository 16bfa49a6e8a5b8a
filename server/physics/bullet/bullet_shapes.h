// Bullet's shapes, built once for each prototype and static and shared by all bodies that use them.
#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "server/physics/body.h"

namespace aureole {

/// Builds a shape when it is first asked for, so that a small world pays for nothing it does not
/// use. Bullet never writes to a shape while stepping, therefore several worlds may share a library
/// as long as one thread at a time steps any of them.
class ShapeLibrary {
 public:
  ShapeLibrary(std::span<const BodyDefinition> prototypes,
               std::span<const StaticDefinition> statics);

  struct Built {
    btCollisionShape* shape = nullptr;
    btVector3 inertia{0, 0, 0};  ///< For the prototype's mass (kg m²); zero for upright bodies.
  };

  std::span<const BodyDefinition> prototypes() const { return prototypes_; }
  std::span<const StaticDefinition> statics() const { return statics_; }
  const Built& prototype(PrototypeId id);
  btCollisionShape* fixed(StaticId id);

 private:
  btCollisionShape* build(const Shape& shape);
  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape);

  btCollisionShape* make(const SphereShape& s);
  btCollisionShape* make(const BoxShape& s);
  btCollisionShape* make(const CapsuleShape& s);
  btCollisionShape* make(const CylinderShape& s);
  btCollisionShape* make(const ConvexHullShape& s);
  btCollisionShape* make(const CompoundShape& s);
  btCollisionShape* make(const PlaneShape& s);

  std::span<const BodyDefinition> prototypes_;
  std::span<const StaticDefinition> statics_;
  std::vector<Built> built_prototypes_;
  std::vector<btCollisionShape*> built_statics_;
  std::vector<std::unique_ptr<btCollisionShape>> owned_;
};

}  // namespace aureole
