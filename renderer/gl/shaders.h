// The shaders, and the uniform block that all of them read.
#pragma once

#include <string>

namespace aureole::render {

/// std140 layout of the block `Frame`. Positions in shaders are relative to the eye.
struct FrameUniforms {
  float view_projection[16];
  float ground_height;    ///< Of the ground plane above the eye (m, negative when below).
  float pixels_per_unit;  ///< Size on the screen (pixels) of 1 m at 1 m distance.
  float fog_density;      ///< 1/m; fog is 1 - exp(-(density · distance)²).
  float unused;
  float grid_origin[4];    ///< Eye's x, z modulo the grid's period (m); then two unused.
  float ground_colour[4];  ///< 0 … 1
};
static_assert(sizeof(FrameUniforms) == 112);

struct ShaderPair {
  std::string vertex, fragment;
};

ShaderPair body_shaders();    ///< Lit, marked, fogged triangles; instanced.
ShaderPair point_shaders();   ///< Far bodies as shaded discs.
ShaderPair ground_shaders();  ///< Plane with a two-scale grid.
ShaderPair shadow_shaders();  ///< Blob shadows.
ShaderPair sky_shaders();     ///< Dome with a gradient and the sun's glow.
ShaderPair wall_shaders();    ///< Translucent boundary walls.

}  // namespace aureole::render
