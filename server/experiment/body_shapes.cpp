// Capsules inside of shapes, and the distance between two segments.
#include "server/experiment/body_shapes.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// Distance between the segments p ± u and q ± v.
/// Source: Ericson, Real-Time Collision Detection, section 5.1.9.
double segment_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& u,
                        const Eigen::Vector3d& q, const Eigen::Vector3d& v) {
  const Eigen::Vector3d d1 = 2 * u, d2 = 2 * v, r = (p - u) - (q - v);
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  constexpr double tiny = 1e-12;
  double s = 0, t = 0;
  if (a <= tiny && e <= tiny) return r.norm();
  if (a <= tiny) {
    t = std::clamp(f / e, 0.0, 1.0);
  } else {
    const double c = d1.dot(r);
    if (e <= tiny) {
      s = std::clamp(-c / a, 0.0, 1.0);
    } else {
      const double b = d1.dot(d2), denominator = a * e - b * b;
      if (denominator > tiny) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
      t = (b * s + f) / e;
      if (t < 0) {
        t = 0;
        s = std::clamp(-c / a, 0.0, 1.0);
      } else if (t > 1) {
        t = 1;
        s = std::clamp((b - c) / a, 0.0, 1.0);
      }
    }
  }
  return (r + d1 * s - d2 * t).norm();
}

}  // namespace

BodyShapes::BodyShapes(const WorldDefinition& world) {
  for (const auto& prototype : world.prototypes) {
    definitions_.push_back(prototype.body);
    radii_.push_back(aureole::bounding_radius(prototype.body.shape));
    capsules_.push_back(inscribed(prototype.body.shape));
  }
  physics_ = std::make_unique<PhysicsWorld>(world.physics, definitions_, no_statics_, 4);
}

BodyShapes::Capsule BodyShapes::inscribed(const Shape& shape) {
  if (const auto* s = std::get_if<SphereShape>(&shape)) return {{0, 0, 0}, s->radius};
  if (const auto* c = std::get_if<CapsuleShape>(&shape))
    return {{0, c->height / 2 - c->radius, 0}, c->radius};
  if (const auto* b = std::get_if<BoxShape>(&shape)) {
    Eigen::Index longest = 0;
    const float most = b->half_extents.maxCoeff(&longest);
    const float radius = b->half_extents.minCoeff();
    Eigen::Vector3f axis{0, 0, 0};
    axis[longest] = most - radius;
    return {axis, radius};
  }
  if (const auto* c = std::get_if<CylinderShape>(&shape)) {
    const float radius = std::min(c->radius, c->height / 2);
    return {{0, c->height / 2 - radius, 0}, radius};
  }
  return {};  // A point: hulls and compounds are seen only when their centres are run over.
}

double BodyShapes::separation(const SeenBody& a, const SeenBody& b) const {
  const Capsule &ca = capsules_[a.prototype.value], &cb = capsules_[b.prototype.value];
  const Eigen::Vector3d u = (a.state.orientation * ca.half_axis).cast<double>();
  const Eigen::Vector3d v = (b.state.orientation * cb.half_axis).cast<double>();
  return segment_distance(a.state.position.vector(), u, b.state.position.vector(), v) - ca.radius -
         cb.radius;
}

bool BodyShapes::collide_in_one_step(const SeenBody& a, const SeenBody& b) const {
  PhysicsWorld both = physics_->scratch(2);
  const NewBody bodies[] = {{a.id, a.prototype, a.state}, {b.id, b.prototype, b.state}};
  both.add(bodies);
  both.wake(a.id);
  both.wake(b.id);
  both.step(tick_s);
  const auto touched = both.touching(a.id);
  return std::find(touched.begin(), touched.end(), b.id) != touched.end();
}

}  // namespace aureole
