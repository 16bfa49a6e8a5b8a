// The sphere around a shape's origin that holds the whole shape: R_o of the aura radius.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/check.h"
#include "server/physics/shape.h"

namespace aureole {
namespace {

/// A shape placed inside a compound; the outermost shape sits at zero, unrotated.
struct Placement {
  Eigen::Vector3f position{0, 0, 0};
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
};

float farthest_point(const Shape& shape, const Placement& at);

float farthest(const SphereShape& s, const Placement& at) {
  return at.position.norm() + s.radius;
}

float farthest(const BoxShape& s, const Placement& at) {
  float radius = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f signs(corner & 1 ? 1.f : -1.f, corner & 2 ? 1.f : -1.f,
                                corner & 4 ? 1.f : -1.f);
    const Eigen::Vector3f local = signs.cwiseProduct(s.half_extents);
    radius = std::max(radius, (at.position + at.orientation * local).norm());
  }
  return radius;
}

float farthest(const CapsuleShape& s, const Placement& at) {
  const Eigen::Vector3f to_cap =
      at.orientation * Eigen::Vector3f(0, std::max(0.f, s.height / 2 - s.radius), 0);
  return std::max((at.position + to_cap).norm(), (at.position - to_cap).norm()) + s.radius;
}

float farthest(const CylinderShape& s, const Placement& at) {
  // The farthest point of a disc lies on its rim, straight away from the origin's foot in its
  // plane.
  const Eigen::Vector3f axis = at.orientation * Eigen::Vector3f::UnitY();
  const float along = at.position.dot(axis);
  const float across = (at.position - along * axis).norm() + s.radius;
  return std::hypot(std::abs(along) + s.height / 2, across);
}

float farthest(const ConvexHullShape& s, const Placement& at) {
  float radius = 0;
  for (const Eigen::Vector3f& p : s.points)
    radius = std::max(radius, (at.position + at.orientation * p).norm());
  return radius;
}

float farthest(const CompoundShape& s, const Placement& at) {
  float radius = 0;
  for (const CompoundShape::Child& child : s.children) {
    AUREOLE_CHECK(child.shape != nullptr, "every child of a compound has a shape");
    const Placement inner{at.position + at.orientation * child.position,
                          at.orientation * child.orientation};
    radius = std::max(radius, farthest_point(*child.shape, inner));
  }
  return radius;
}

float farthest(const PlaneShape&, const Placement&) {
  return std::numeric_limits<float>::infinity();
}

float farthest_point(const Shape& shape, const Placement& at) {
  using Variant = Shape::variant;
  return std::visit([&](const auto& s) { return farthest(s, at); },
                    static_cast<const Variant&>(shape));
}

}  // namespace

float bounding_radius(const Shape& shape) {
  return farthest_point(shape, Placement{});
}

}  // namespace aureole
