// Soft blob shadows: one ellipse under each body, on the ground or on the platform below it.
#include "renderer/drawing/shadows.h"

#include <algorithm>
#include <cmath>

namespace aureole::render {
namespace {

using Eigen::Vector3f;

constexpr float strength_at_contact = 0.5f;
// Above this distance from its receiver a body casts none (m).
constexpr float height_max_m = 9.0f;
// The ellipse that fits into a box misses its corners, and its rim is soft.
constexpr float ellipse_growth = 1.5f;

Eigen::Matrix3f rotation_of(const Instance& instance) {
  const auto& q = instance.orientation;
  return Eigen::Quaternionf(q[3], q[0], q[1], q[2]).toRotationMatrix();
}

// Height of the receiver's plane at (x, z).
float plane_height(const ShadowReceiver& r, float x, float z) {
  return r.centre.y() -
         (r.normal.x() * (x - r.centre.x()) + r.normal.z() * (z - r.centre.z())) / r.normal.y();
}

}  // namespace

ShadowReceiver upper_face(const BoxShape& box, const Instance& instance) {
  const Eigen::Matrix3f rotation = rotation_of(instance);
  int up = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(rotation(1, k)) > std::abs(rotation(1, up))) up = k;
  const int u = (up + 1) % 3, v = (up + 2) % 3;
  const float side = rotation(1, up) < 0 ? -1.0f : 1.0f;
  ShadowReceiver face;
  face.normal = rotation.col(up) * side;
  face.centre = instance.position + face.normal * box.half_extents[up];
  face.axis_u = rotation.col(u);
  face.axis_v = rotation.col(v);
  face.half_u = box.half_extents[u];
  face.half_v = box.half_extents[v];
  return face;
}

bool cast_shadow(const Instance& body, const Vector3f& half_extents,
                 std::span<const ShadowReceiver> receivers, const ShadowGround& ground,
                 const Vector3f& eye, ShadowQuad& quad) {
  const Vector3f& p = body.position;
  ShadowReceiver plane;
  plane.centre = {p.x(), ground.height_m, p.z()};
  plane.axis_u = Vector3f::UnitX();
  plane.axis_v = Vector3f::UnitZ();
  plane.normal = Vector3f::UnitY();
  plane.half_u = plane.half_v = 1e6f;
  const ShadowReceiver* chosen = ground.present && p.y() >= ground.height_m ? &plane : nullptr;
  float chosen_height = ground.present ? ground.height_m : -1e30f;
  for (const ShadowReceiver& r : receivers) {
    const float y = plane_height(r, p.x(), p.z());
    if (y > p.y() || y <= chosen_height) continue;
    const Vector3f offset = Vector3f(p.x(), y, p.z()) - r.centre;
    if (std::abs(offset.dot(r.axis_u)) > r.half_u || std::abs(offset.dot(r.axis_v)) > r.half_v)
      continue;
    chosen = &r;
    chosen_height = y;
  }
  if (chosen == nullptr) return false;

  // The body's axes, laid flat: their outer products add up to the matrix of the ellipse below it.
  const Eigen::Matrix3f reach = rotation_of(body) * half_extents.asDiagonal();
  const float half_height = reach.row(1).norm();
  const float gap = std::max(0.0f, p.y() - half_height - chosen_height);
  if (gap > height_max_m) return false;
  const Eigen::RowVector3f along_u = chosen->axis_u.transpose() * reach;
  const Eigen::RowVector3f along_v = chosen->axis_v.transpose() * reach;
  const float blur = 0.05f + 0.22f * gap;
  const float growth = ellipse_growth * ellipse_growth;
  const float uu = along_u.squaredNorm() * growth + blur * blur;
  const float vv = along_v.squaredNorm() * growth + blur * blur;
  const float uv = along_u.dot(along_v) * growth;
  // Cholesky: [uu uv; uv vv] = L Lᵀ, and L⁻¹ takes the ellipse to the unit circle.
  const float l00 = std::sqrt(uu), l10 = uv / l00;
  const float l11 = std::sqrt(std::max(vv - l10 * l10, 1e-6f));

  // The key light comes from one side, so a shadow drifts away from below its body as this rises.
  const float drift = std::min(p.y() - chosen_height, 3.0f);
  Vector3f centre(p.x() - 0.22f * drift, 0, p.z() - 0.16f * drift);
  centre.y() = plane_height(*chosen, centre.x(), centre.z());
  const Vector3f offset = centre - chosen->centre;
  const float at_u = offset.dot(chosen->axis_u), at_v = offset.dot(chosen->axis_v);
  const float reach_u = std::sqrt(uu), reach_v = std::sqrt(vv);

  const float size = std::sqrt(l00 * l11);
  const float fade = 1.0f - gap / height_max_m;
  const float strength = strength_at_contact * fade * fade / (1.0f + 0.35f * gap / (size + 0.1f));
  centre += chosen->normal * 0.006f - eye;
  quad = {{centre.x(), centre.y(), centre.z()},
          strength,
          {chosen->axis_u.x(), chosen->axis_u.y(), chosen->axis_u.z()},
          -l10 / (l00 * l11),
          {chosen->axis_v.x(), chosen->axis_v.y(), chosen->axis_v.z()},
          1 / l00,
          {std::max(-reach_u, -chosen->half_u - at_u), std::min(reach_u, chosen->half_u - at_u),
           std::max(-reach_v, -chosen->half_v - at_v), std::min(reach_v, chosen->half_v - at_v)},
          1 / l11,
          {0, 0, 0}};
  return quad.bounds[0] < quad.bounds[1] && quad.bounds[2] < quad.bounds[3];
}

}  // namespace aureole::render
