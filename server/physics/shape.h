// Shapes of bodies as plain data: what a world file describes, physics builds and the renderer
// draws.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <variant>
#include <vector>

namespace aureole {

struct Shape;

/// Radius > 0 (unit: m).
struct SphereShape {
  float radius;
};
/// Half edge lengths, each > 0 (unit: m).
struct BoxShape {
  Eigen::Vector3f half_extents;
};
/// Along y. `height` is the whole height with both caps, ≥ 2 radius (unit: m); Bullet leaves the
/// caps out.
struct CapsuleShape {
  float radius;
  float height;
};
/// Along y, centred (unit: m).
struct CylinderShape {
  float radius;
  float height;
};
/// 4 to 64 points not all in one plane, around the centre of mass as origin (unit: m).
struct ConvexHullShape {
  std::vector<Eigen::Vector3f> points;
};
/// 1 to 16 children that are not compounds themselves, around the centre of mass as origin.
struct CompoundShape {
  struct Child {
    std::shared_ptr<const Shape> shape;
    Eigen::Vector3f position{0, 0, 0};
    Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
  };
  std::vector<Child> children;
};
/// Half-space below a horizontal plane through the static's position; static geometry only.
struct PlaneShape {};

struct Shape : std::variant<SphereShape, BoxShape, CapsuleShape, CylinderShape, ConvexHullShape,
                            CompoundShape, PlaneShape> {
  using variant::variant;
};

/// Radius R_o of the sphere around the shape's origin that holds it (unit: m); infinite for a
/// plane. A capsule of height 2 m and radius 0.3 m has R_o = 1 m.
float bounding_radius(const Shape& shape);

/// A segment through the shape's origin, and how thick it must be to hold the shape: much closer
/// around a capsule or a plank than a sphere is.
struct Spine {
  Eigen::Vector3f half{0, 0, 0};  ///< From the middle to either end, in the shape's frame (m).
  float girth = 0;                ///< m
  float lowest = 0;  ///< The shape's origin can be no lower over a level plane (m), or a bit more.
};
Spine spine(const Shape& shape);

/// How fast the room that the shape takes up moves, or would if its spin became motion; or a little
/// more (m/s). A ball that spins in its place takes up no other room, but it may start to roll.
float motion_speed(const Shape& shape, const Eigen::Quaternionf& orientation,
                   const Eigen::Vector3f& velocity_mps, const Eigen::Vector3f& spin_radps);

}  // namespace aureole
