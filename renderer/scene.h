// What a frame shows, as plain data: the renderer knows nothing else of the world.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aureole::render {

/// Linear in sRGB bytes.
struct Rgb {
  std::uint8_t r = 200, g = 200, b = 200;
};

/// Index into the mesh table that a Renderer was made with.
using MeshIndex = std::uint16_t;

/// One drawn thing: a rigid pose of a mesh. Instances are drawn sorted by `sort_key`, so that a
/// frame depends on the scene alone and not on the order in which it was gathered.
struct Instance {
  std::uint64_t sort_key = 0;
  MeshIndex mesh = 0;
  Rgb colour;
  Eigen::Vector3f position{0, 0, 0};        ///< World, m; y is up.
  Eigen::Vector4f orientation{0, 0, 0, 1};  ///< Unit quaternion x, y, z, w.
};

/// Right-handed; yaw 0 looks along -z, positive yaw turns left (towards -x); pitch > 0 looks up.
struct Camera {
  Eigen::Vector3f eye{0, 2, 0};
  float yaw_rad = 0;
  float pitch_rad = 0;
  float vertical_fov_rad = 1.1f;
  float near_m = 0.08f;
  float far_m = 600.0f;
};

/// A vertical plane segment over the ground that marks a boundary between regions.
struct BoundaryLine {
  Eigen::Vector2f from_xz{0, 0}, to_xz{0, 0};
};

/// What is the same in every view of one moment.
struct Scene {
  std::vector<Instance> instances;       ///< Moving things; any order.
  std::vector<BoundaryLine> boundaries;  ///< Drawn as translucent walls if the view asks for them.
};

/// One player's view.
struct View {
  Camera camera;
  int width = 1280, height = 720;  ///< 16 … 3840, 16 … 2160
  bool show_boundaries = false;
  std::uint64_t hidden_key = 0;  ///< Instance left out (one's own avatar); 0 for none.
};

}  // namespace aureole::render
