// What a camera sees: directions, sides, sizes on the screen and levels of detail.
#include "renderer/drawing/culling.h"

#include <cmath>

#include "renderer/mesh/mesh.h"
#include "tests/support/catch.h"

namespace aureole::render {
namespace {

using Eigen::Vector3f;

Camera camera_towards(float yaw, float pitch) {
  Camera camera;
  camera.yaw_rad = yaw;
  camera.pitch_rad = pitch;
  return camera;
}

// Whether a point relative to the eye lies inside the clip volume.
bool inside_clip(const Camera& camera, const Vector3f& p) {
  const Eigen::Vector4f clip = view_projection(camera, 1280, 720) * p.homogeneous();
  return std::abs(clip.x()) <= clip.w() && std::abs(clip.y()) <= clip.w() &&
         std::abs(clip.z()) <= clip.w();
}

}  // namespace

TEST_CASE("Yaw 0 looks along -z, positive yaw turns left, positive pitch looks up") {
  CHECK(camera_axes(camera_towards(0, 0)).forward.isApprox(Vector3f(0, 0, -1), 1e-6f));
  CHECK(camera_axes(camera_towards(1.5707963f, 0)).forward.isApprox(Vector3f(-1, 0, 0), 1e-6f));
  CHECK(camera_axes(camera_towards(0, 0.5f)).forward.y() == Approx(std::sin(0.5f)));
  const CameraAxes axes = camera_axes(camera_towards(0.7f, -0.4f));
  CHECK(axes.right.cross(axes.up).isApprox(-axes.forward, 1e-6f));
  CHECK(axes.right.y() == 0);
}

TEST_CASE("What is right of the camera appears right, what is above appears above") {
  const Camera camera = camera_towards(0.6f, 0.2f);
  const CameraAxes axes = camera_axes(camera);
  const Eigen::Matrix4f m = view_projection(camera, 1280, 720);
  const Eigen::Vector4f clip =
      m * Vector3f(axes.forward * 10 + axes.right * 2 + axes.up).homogeneous();
  CHECK(clip.w() == Approx(10));
  CHECK(clip.x() > 0);
  CHECK(clip.y() > 0);
}

TEST_CASE("A sphere behind the camera or outside a side is never seen") {
  const Frustum frustum(camera_towards(0, 0), 1280, 720);
  CHECK(!frustum.sees({0, 0, 5}, 1));
  CHECK(!frustum.sees({0, 0, -700}, 1));
  CHECK(!frustum.sees({60, 0, -10}, 1));
  CHECK(!frustum.sees({-60, 0, -10}, 1));
  CHECK(!frustum.sees({0, 30, -10}, 1));
  CHECK(!frustum.sees({0, -30, -10}, 1));
}

TEST_CASE("A sphere that reaches into the view is always seen") {
  const Frustum frustum(camera_towards(0, 0), 1280, 720);
  CHECK(frustum.sees({0, 0, -10}, 0.1f));
  CHECK(frustum.sees({0, 0, 0.5f}, 1));
  CHECK(frustum.sees({60, 0, -10}, 60));
}

TEST_CASE("No sphere with a visible point in it is culled, in whatever direction one looks") {
  int visible = 0, culled = 0;
  for (int turn = 0; turn < 12; ++turn) {
    const Camera camera =
        camera_towards(static_cast<float>(turn) * 0.53f, 0.25f * static_cast<float>(turn % 5 - 2));
    const Frustum frustum(camera, 1280, 720);
    for (int x = -20; x <= 20; ++x) {
      for (int y = -4; y <= 4; ++y) {
        for (int z = -20; z <= 20; ++z) {
          const Vector3f centre(static_cast<float>(x), static_cast<float>(y),
                                static_cast<float>(z));
          const bool sees = frustum.sees(centre, 0.4f);
          if (inside_clip(camera, centre)) {
            REQUIRE(sees);
            ++visible;
          } else if (!sees) {
            ++culled;
          }
        }
      }
    }
  }
  CHECK(visible > 5000);
  CHECK(culled > 100000);
}

TEST_CASE("Size on the screen follows the perspective") {
  Camera camera = camera_towards(0, 0);
  camera.vertical_fov_rad = 1.5707963f;
  const Frustum frustum(camera, 1280, 720);
  // A right angle of view shows 20 m at 10 m distance on 720 pixels.
  CHECK(frustum.diameter_px({0, 0, -10}, 1) == Approx(72));
  CHECK(frustum.diameter_px({0, 0, -20}, 1) == Approx(36));
  CHECK(frustum.diameter_px({0, 0, 0}, 1) > 1000);
}

TEST_CASE("Small bodies are points, and detail grows with size") {
  CHECK(level_for(point_below_px - 0.1f, level_count_max) == -1);
  int previous = level_count_max - 1;
  CHECK(level_for(point_below_px, level_count_max) == previous);
  for (float px = point_below_px; px < 400; px += 1) {
    const int level = level_for(px, level_count_max);
    REQUIRE(level <= previous);
    previous = level;
  }
  CHECK(previous == 0);
  CHECK(level_for(400, 1) == 0);
  CHECK(level_for(point_below_px, 1) == 0);
}

}  // namespace aureole::render
