// Rays against spheres, boxes, capsules, cylinders and what is made of them.
#include "server/gateway/players/picking.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aureole {
namespace {

using Eigen::Vector3f;
using Hit = std::optional<float>;

Hit nearer(Hit a, Hit b) {
  if (!a) return b;
  if (!b) return a;
  return std::min(*a, *b);
}

Hit ray_sphere(const Vector3f& centre, float radius, const Vector3f& from, const Vector3f& along) {
  const Vector3f offset = from - centre;
  const float b = offset.dot(along);
  const float c = offset.squaredNorm() - radius * radius;
  if (c <= 0) return 0.0f;
  const float discriminant = b * b - c;
  if (b > 0 || discriminant < 0) return std::nullopt;
  return -b - std::sqrt(discriminant);
}

/// Slab by slab; an edge-on ray inside a slab divides by zero to infinities of the right sign.
Hit ray_box(const Vector3f& centre, const Vector3f& half, const Vector3f& from,
            const Vector3f& along) {
  float enter = 0, leave = std::numeric_limits<float>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const float offset = centre[axis] - from[axis];
    if (along[axis] == 0) {
      if (std::abs(offset) > half[axis]) return std::nullopt;
      continue;
    }
    const float a = (offset - half[axis]) / along[axis], b = (offset + half[axis]) / along[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return std::nullopt;
  return enter;
}

/// The side of a cylinder along y, without its ends.
Hit ray_tube(float radius, float half_height, const Vector3f& from, const Vector3f& along) {
  const float a = along.x() * along.x() + along.z() * along.z();
  const float b = from.x() * along.x() + from.z() * along.z();
  const float c = from.x() * from.x() + from.z() * from.z() - radius * radius;
  if (c <= 0 && std::abs(from.y()) <= half_height) return 0.0f;
  const float discriminant = b * b - a * c;
  if (a <= 0 || discriminant < 0) return std::nullopt;
  const float distance = (-b - std::sqrt(discriminant)) / a;
  if (distance < 0 || std::abs(from.y() + distance * along.y()) > half_height) return std::nullopt;
  return distance;
}

Hit ray_disc(float y, float radius, const Vector3f& from, const Vector3f& along) {
  if (along.y() == 0) return std::nullopt;
  const float distance = (y - from.y()) / along.y();
  if (distance < 0) return std::nullopt;
  const Vector3f at = from + distance * along;
  if (at.x() * at.x() + at.z() * at.z() > radius * radius) return std::nullopt;
  return distance;
}

struct RayAgainst {
  const Vector3f& from;
  const Vector3f& along;

  Hit operator()(const SphereShape& s) const {
    return ray_sphere(Vector3f::Zero(), s.radius, from, along);
  }
  Hit operator()(const BoxShape& s) const {
    return ray_box(Vector3f::Zero(), s.half_extents, from, along);
  }
  Hit operator()(const CapsuleShape& s) const {
    const float half = std::max(s.height / 2 - s.radius, 0.0f);
    const Hit caps = nearer(ray_sphere({0, half, 0}, s.radius, from, along),
                            ray_sphere({0, -half, 0}, s.radius, from, along));
    return nearer(caps, ray_tube(s.radius, half, from, along));
  }
  Hit operator()(const CylinderShape& s) const {
    const Hit ends = nearer(ray_disc(s.height / 2, s.radius, from, along),
                            ray_disc(-s.height / 2, s.radius, from, along));
    return nearer(ends, ray_tube(s.radius, s.height / 2, from, along));
  }
  Hit operator()(const ConvexHullShape& s) const {
    Vector3f low = Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
    for (const Vector3f& point : s.points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    return ray_box((low + high) / 2, (high - low) / 2, from, along);
  }
  Hit operator()(const CompoundShape& s) const {
    Hit nearest;
    for (const auto& child : s.children) {
      const Eigen::Quaternionf back = child.orientation.conjugate();
      nearest =
          nearer(nearest, ray_hits(*child.shape, back * (from - child.position), back * along));
    }
    return nearest;
  }
  Hit operator()(const PlaneShape&) const {
    if (from.y() <= 0) return 0.0f;
    if (along.y() >= 0) return std::nullopt;
    return -from.y() / along.y();
  }
};

struct Pose {
  const WorldPosition& position;
  const Eigen::Quaternionf& orientation;
};

Hit ray_hits_posed(const Shape& shape, const Pose& pose, const WorldPosition& eye,
                   const Vector3f& along) {
  const Eigen::Quaternionf back = pose.orientation.conjugate();
  return ray_hits(shape, back * eye.relative_to(pose.position), back * along);
}

}  // namespace

Eigen::Vector3f look_direction(Look look) {
  return {-std::sin(look.yaw) * std::cos(look.pitch), std::sin(look.pitch),
          -std::cos(look.yaw) * std::cos(look.pitch)};
}

std::optional<float> ray_hits(const Shape& shape, const Vector3f& from, const Vector3f& direction) {
  return std::visit(RayAgainst{from, direction}, static_cast<const Shape::variant&>(shape));
}

std::optional<BodyId> pick_body(const WorldDefinition& world, std::span<const ReplicaPose> poses,
                                const GrabRay& ray) {
  const Vector3f along = look_direction(ray.look);
  float nearest = grab_reach_m;
  std::optional<BodyId> picked;

  for (const WorldStatic& wall : world.statics) {
    const Hit hit = ray_hits_posed(wall.body.shape, {wall.body.position, wall.body.orientation},
                                   ray.eye, along);
    if (hit && *hit < nearest) nearest = *hit;
  }
  for (const ReplicaPose& pose : poses) {
    // One looks out of one's own head, and nobody is carried about.
    if (pose.id.kind() == BodyId::Kind::avatar) continue;
    if (pose.prototype.value >= world.prototypes.size()) continue;
    const BodyDefinition& body = world.prototypes[pose.prototype.value].body;
    const Vector3f offset = pose.position.relative_to(ray.eye);
    if (!ray_sphere(offset, bounding_radius(body.shape), Vector3f::Zero(), along)) continue;
    const Hit hit = ray_hits_posed(body.shape, {pose.position, pose.orientation}, ray.eye, along);
    // Equal distances: the lower id, so that the order of the poses does not matter.
    if (!hit || *hit > nearest || (*hit == nearest && picked && *picked < pose.id)) continue;
    nearest = *hit;
    picked = body.mass_kg <= grab_mass_max_kg ? std::optional(pose.id) : std::nullopt;
  }
  return picked;
}

}  // namespace aureole
