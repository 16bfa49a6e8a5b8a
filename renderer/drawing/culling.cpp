// What a camera sees, and in how much detail.
#include "renderer/drawing/culling.h"

#include <cmath>

#include "renderer/mesh/mesh.h"

namespace aureole::render {

CameraAxes camera_axes(const Camera& camera) {
  const float sy = std::sin(camera.yaw_rad), cy = std::cos(camera.yaw_rad);
  const float sp = std::sin(camera.pitch_rad), cp = std::cos(camera.pitch_rad);
  const Eigen::Vector3f forward(-sy * cp, sp, -cy * cp);
  const Eigen::Vector3f right(cy, 0, -sy);
  return {right, right.cross(forward), forward};
}

Eigen::Matrix4f view_projection(const Camera& camera, int width, int height) {
  const CameraAxes axes = camera_axes(camera);
  const float focal = 1.0f / std::tan(camera.vertical_fov_rad / 2);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float n = camera.near_m, f = camera.far_m;
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m.block<1, 3>(0, 0) = axes.right.transpose() * (focal / aspect);
  m.block<1, 3>(1, 0) = axes.up.transpose() * focal;
  m.block<1, 3>(2, 0) = axes.forward.transpose() * ((f + n) / (f - n));
  m(2, 3) = -2 * f * n / (f - n);
  m.block<1, 3>(3, 0) = axes.forward.transpose();
  return m;
}

Frustum::Frustum(const Camera& camera, int width, int height)
    : axes_(camera_axes(camera)), near_m_(camera.near_m), far_m_(camera.far_m) {
  const float half_up = camera.vertical_fov_rad / 2;
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float half_side = std::atan(std::tan(half_up) * aspect);
  focal_px_ = static_cast<float>(height) / 2 / std::tan(half_up);
  side_normal_ = {std::cos(half_side), std::sin(half_side)};
  up_normal_ = {std::cos(half_up), std::sin(half_up)};
}

int level_for(float diameter_px, int levels) {
  if (diameter_px < point_below_px) return -1;
  constexpr float least_px[level_count_max - 1] = {110, 52, 28, 16};
  int level = 0;
  while (level < level_count_max - 1 && diameter_px < least_px[level]) ++level;
  return level < levels ? level : levels - 1;
}

}  // namespace aureole::render
