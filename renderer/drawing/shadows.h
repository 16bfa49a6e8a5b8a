// Soft blob shadows: one ellipse under each body, on the ground or on the platform below it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "renderer/mesh/mesh.h"
#include "renderer/scene.h"

namespace aureole::render {

/// A rectangle on a flat receiver, as the vertex shader reads it; positions relative to the eye
/// (m).
struct ShadowQuad {
  float centre[3];
  float strength;   ///< Darkest alpha, 0 … 1.
  float axis_u[3];  ///< Unit vectors that span the receiver.
  float shear;      ///< With scale_u and scale_v: takes (u, v) in m to where the ellipse is the
  float axis_v[3];  ///< unit circle: (u · scale_u, u · shear + v · scale_v).
  float scale_u;
  float bounds[4];  ///< u from, u to, v from, v to (m), cut to the receiver.
  float scale_v;
  float unused[3];
};
static_assert(sizeof(ShadowQuad) == 80);

/// The upper face of a static box.
struct ShadowReceiver {
  Eigen::Vector3f centre, axis_u, axis_v, normal;
  float half_u = 0, half_v = 0;  ///< m
};

/// Upper face of a box posed like `instance`; its normal is the most upright of the six.
ShadowReceiver upper_face(const BoxShape& box, const Instance& instance);

struct ShadowGround {
  bool present = true;
  float height_m = 0;
};

/// The shadow of a body with the given half extents, on the highest receiver below its centre.
/// False if there is none near enough to be seen.
bool cast_shadow(const Instance& body, const Eigen::Vector3f& half_extents,
                 std::span<const ShadowReceiver> receivers, const ShadowGround& ground,
                 const Eigen::Vector3f& eye, ShadowQuad& quad);

}  // namespace aureole::render
