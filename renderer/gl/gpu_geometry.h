// Buffers, programs and draw calls of one renderer.
#pragma once

#include <span>
#include <vector>

#include "renderer/drawing/backdrop.h"
#include "renderer/drawing/draw_list.h"
#include "renderer/gl/gl.h"
#include "renderer/gl/shaders.h"
#include "renderer/mesh/mesh.h"
#include "renderer/outcome.h"

namespace aureole::render {

/// Everything is made in the context that is current at `upload` and dies with it.
class GpuGeometry {
 public:
  /// Compiles the programs and uploads all meshes; once, before anything else.
  Outcome<bool> upload(std::span<const Mesh> meshes, float ground_reach_m);
  /// Uploads what changes from frame to frame.
  void begin_frame(const FrameUniforms& uniforms, const DrawList& list,
                   std::span<const WallVertex> walls);
  /// Draws all of it into the framebuffer that is bound.
  void draw(std::span<const Mesh> meshes, const DrawList& list, bool ground);

 private:
  struct LevelRange {
    GLsizei index_count = 0;
    std::size_t first_index = 0;
    GLint base_vertex = 0;
  };
  struct Indexed {
    GLuint array = 0;
    GLsizei index_count = 0;
  };
  Outcome<bool> make_programs();
  void upload_meshes(std::span<const Mesh> meshes);
  template <class Point>
  static Indexed upload_list(const TriangleList<Point>& list);
  void make_stream_arrays();
  void draw_bodies(std::span<const Mesh> meshes, const DrawList& list) const;

  GLuint body_program_ = 0, point_program_ = 0, ground_program_ = 0, shadow_program_ = 0,
         sky_program_ = 0, wall_program_ = 0;
  GLint point_uniform_ = -1;
  GLuint uniforms_ = 0, instances_ = 0, shadows_ = 0, walls_ = 0;
  GLuint mesh_vertices_ = 0, mesh_indices_ = 0;
  GLuint body_array_ = 0, point_array_ = 0, shadow_array_ = 0, wall_array_ = 0;
  Indexed ground_, sky_;
  GLsizei sky_above_ground_ = 0, wall_vertices_ = 0;
  std::vector<LevelRange> ranges_;  ///< level_count_max for each mesh.
};

}  // namespace aureole::render
