// What a camera sees, and in how much detail: pure functions of camera and sphere.
#pragma once

#include <Eigen/Core>
#include <array>

#include "renderer/scene.h"

namespace aureole::render {

/// Unit vectors of the camera's own axes in the world.
struct CameraAxes {
  Eigen::Vector3f right, up, forward;
};
CameraAxes camera_axes(const Camera& camera);

/// Takes points relative to the eye (world axes) to clip space; column-major, as OpenGL takes it.
/// Everything is drawn relative to the eye, so that floats suffice far away from the world's
/// origin.
Eigen::Matrix4f view_projection(const Camera& camera, int width, int height);

/// The camera's view as half-spaces, and the size of things on the screen.
class Frustum {
 public:
  Frustum(const Camera& camera, int width, int height);

  /// False only if a sphere (centre relative to the eye, m) lies wholly outside: behind the near
  /// plane, beyond the far distance or past a side.
  bool sees(const Eigen::Vector3f& centre, float radius) const {
    const float depth = centre.dot(axes_.forward);
    if (depth < near_m_ - radius || depth > far_m_ + radius) return false;
    const float side = centre.dot(axes_.right), height = centre.dot(axes_.up);
    // The side planes are symmetric, so one of each pair decides.
    return side_normal_[0] * (side < 0 ? -side : side) - side_normal_[1] * depth < radius &&
           up_normal_[0] * (height < 0 ? -height : height) - up_normal_[1] * depth < radius;
  }

  /// Diameter on the screen (pixels) of a sphere; huge for one that holds the eye.
  float diameter_px(const Eigen::Vector3f& centre, float radius) const {
    const float depth = centre.dot(axes_.forward);
    return 2 * radius * focal_px_ / (depth > near_m_ ? depth : near_m_);
  }

 private:
  CameraAxes axes_;
  float near_m_, far_m_, focal_px_;
  std::array<float, 2> side_normal_, up_normal_;
};

/// Bodies smaller than this on the screen are drawn as points (unit: pixels).
inline constexpr float point_below_px = 9.0f;

/// Level of detail for a body of this diameter on the screen, among `levels` (1 … level_count_max);
/// -1 for a point. A mesh with one level shows it at every size.
int level_for(float diameter_px, int levels);

}  // namespace aureole::render
