// Buffers, programs and draw calls of one renderer.
#include "renderer/gl/gpu_geometry.h"

#include <array>
#include <cstddef>

#include "renderer/gl/gl_program.h"

namespace aureole::render {
namespace {

GLuint make_buffer(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, usage);
  return buffer;
}

const void* buffer_offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

// Floats of the buffer that is bound, from `offset` on, `stride` bytes apart.
void float_attribute(GLuint location, GLint size, std::size_t stride, std::size_t offset,
                     GLuint divisor = 0) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                        buffer_offset(offset));
  glVertexAttribDivisor(location, divisor);
}

void byte_attribute(GLuint location, GLenum type, std::size_t stride, std::size_t offset,
                    GLuint divisor = 0) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, 4, type, GL_TRUE, static_cast<GLsizei>(stride),
                        buffer_offset(offset));
  glVertexAttribDivisor(location, divisor);
}

void instance_attributes(GLuint first_location, GLuint divisor) {
  constexpr std::size_t stride = sizeof(DrawnInstance);
  float_attribute(first_location, 3, stride, offsetof(DrawnInstance, position), divisor);
  float_attribute(first_location + 1, 4, stride, offsetof(DrawnInstance, orientation), divisor);
  byte_attribute(first_location + 2, GL_UNSIGNED_BYTE, stride, offsetof(DrawnInstance, colour),
                 divisor);
}

template <class T>
void stream(GLuint buffer, std::span<const T> data) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size_bytes()), data.data(),
               GL_STREAM_DRAW);
}

}  // namespace

Outcome<bool> GpuGeometry::make_programs() {
  struct Wanted {
    const char* name;
    ShaderPair sources;
    GLuint* program;
  };
  const std::array<Wanted, 6> wanted{{{"bodies", body_shaders(), &body_program_},
                                      {"points", point_shaders(), &point_program_},
                                      {"ground", ground_shaders(), &ground_program_},
                                      {"shadows", shadow_shaders(), &shadow_program_},
                                      {"sky", sky_shaders(), &sky_program_},
                                      {"walls", wall_shaders(), &wall_program_}}};
  for (const Wanted& w : wanted) {
    const auto program = link_program(w.name, w.sources.vertex, w.sources.fragment);
    if (!program) return program.failure();
    *w.program = *program;
  }
  point_uniform_ = glGetUniformLocation(point_program_, "radius_and_lightness");
  return true;
}

void GpuGeometry::upload_meshes(std::span<const Mesh> meshes) {
  std::vector<Vertex> vertices;
  std::vector<std::uint16_t> indices;
  ranges_.assign(meshes.size() * level_count_max, {});
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::size_t k = 0; k < meshes[m].levels.size(); ++k) {
      const MeshLevel& level = meshes[m].levels[k];
      ranges_[m * level_count_max + k] = {static_cast<GLsizei>(level.indices.size()),
                                          indices.size(), static_cast<GLint>(vertices.size())};
      vertices.insert(vertices.end(), level.vertices.begin(), level.vertices.end());
      indices.insert(indices.end(), level.indices.begin(), level.indices.end());
    }
  }
  glGenVertexArrays(1, &body_array_);
  glBindVertexArray(body_array_);
  mesh_vertices_ = make_buffer(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * sizeof(Vertex),
                               GL_STATIC_DRAW);
  float_attribute(0, 3, sizeof(Vertex), offsetof(Vertex, x));
  byte_attribute(1, GL_BYTE, sizeof(Vertex), offsetof(Vertex, normal_x));
  float_attribute(2, 4, sizeof(Vertex), offsetof(Vertex, mark_u));
  mesh_indices_ = make_buffer(GL_ELEMENT_ARRAY_BUFFER, indices.data(),
                              indices.size() * sizeof(std::uint16_t), GL_STATIC_DRAW);
}

template <class Point>
GpuGeometry::Indexed GpuGeometry::upload_list(const TriangleList<Point>& list) {
  Indexed result;
  glGenVertexArrays(1, &result.array);
  glBindVertexArray(result.array);
  make_buffer(GL_ARRAY_BUFFER, list.points.data(), list.points.size() * sizeof(Point),
              GL_STATIC_DRAW);
  float_attribute(0, Point::RowsAtCompileTime, sizeof(Point), 0);
  make_buffer(GL_ELEMENT_ARRAY_BUFFER, list.indices.data(),
              list.indices.size() * sizeof(std::uint16_t), GL_STATIC_DRAW);
  result.index_count = static_cast<GLsizei>(list.indices.size());
  return result;
}

void GpuGeometry::make_stream_arrays() {
  instances_ = make_buffer(GL_ARRAY_BUFFER, nullptr, 0, GL_STREAM_DRAW);
  glBindVertexArray(body_array_);
  instance_attributes(3, 1);
  glGenVertexArrays(1, &point_array_);
  glBindVertexArray(point_array_);
  instance_attributes(0, 0);

  glGenVertexArrays(1, &shadow_array_);
  glBindVertexArray(shadow_array_);
  shadows_ = make_buffer(GL_ARRAY_BUFFER, nullptr, 0, GL_STREAM_DRAW);
  for (GLuint k = 0; k < 4; ++k) float_attribute(k, 4, sizeof(ShadowQuad), k * 16, 1);
  float_attribute(4, 1, sizeof(ShadowQuad), offsetof(ShadowQuad, scale_v), 1);

  glGenVertexArrays(1, &wall_array_);
  glBindVertexArray(wall_array_);
  walls_ = make_buffer(GL_ARRAY_BUFFER, nullptr, 0, GL_STREAM_DRAW);
  float_attribute(0, 3, sizeof(WallVertex), 0);
  float_attribute(1, 1, sizeof(WallVertex), offsetof(WallVertex, up));

  uniforms_ = make_buffer(GL_UNIFORM_BUFFER, nullptr, sizeof(FrameUniforms), GL_STREAM_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, uniforms_);
}

Outcome<bool> GpuGeometry::upload(std::span<const Mesh> meshes, float ground_reach_m) {
  auto programs = make_programs();
  if (!programs) return programs;
  upload_meshes(meshes);
  ground_ = upload_list(ground_rings(ground_reach_m));
  sky_ = upload_list(sky_dome());
  sky_above_ground_ = static_cast<GLsizei>(sky_above_ground_indices());
  make_stream_arrays();
  glEnable(GL_PROGRAM_POINT_SIZE);
  glDepthFunc(GL_LEQUAL);
  glEnable(GL_DEPTH_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (glGetError() != GL_NO_ERROR)
    return Failure{"the OpenGL driver refuses the renderer's buffers; it must offer OpenGL 4.2"};
  return true;
}

void GpuGeometry::begin_frame(const FrameUniforms& uniforms, const DrawList& list,
                              std::span<const WallVertex> walls) {
  glBindBuffer(GL_UNIFORM_BUFFER, uniforms_);
  glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(uniforms), &uniforms);
  stream(instances_, list.instances());
  stream(shadows_, list.shadows());
  stream(walls_, walls);
  wall_vertices_ = static_cast<GLsizei>(walls.size());
}

void GpuGeometry::draw_bodies(std::span<const Mesh> meshes, const DrawList& list) const {
  glEnable(GL_CULL_FACE);
  glUseProgram(body_program_);
  glBindVertexArray(body_array_);
  for (const DrawBucket& b : list.buckets()) {
    if (b.level < 0) continue;
    const LevelRange& range =
        ranges_[std::size_t{b.mesh} * level_count_max + static_cast<std::size_t>(b.level)];
    glDrawElementsInstancedBaseVertexBaseInstance(
        GL_TRIANGLES, range.index_count, GL_UNSIGNED_SHORT,
        buffer_offset(range.first_index * sizeof(std::uint16_t)), static_cast<GLsizei>(b.count),
        range.base_vertex, b.first);
  }
  glDisable(GL_CULL_FACE);
  glUseProgram(point_program_);
  glBindVertexArray(point_array_);
  for (const DrawBucket& b : list.buckets()) {
    if (b.level >= 0) continue;
    glUniform2f(point_uniform_, meshes[b.mesh].point_radius, meshes[b.mesh].point_lightness);
    glDrawArrays(GL_POINTS, static_cast<GLint>(b.first), static_cast<GLsizei>(b.count));
  }
}

void GpuGeometry::draw(std::span<const Mesh> meshes, const DrawList& list, bool ground) {
  // Most of the sky lies behind nothing: without a depth test it costs least, even where it is
  // hidden.
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(sky_program_);
  glBindVertexArray(sky_.array);
  glDrawElements(GL_TRIANGLES, ground ? sky_above_ground_ : sky_.index_count, GL_UNSIGNED_SHORT,
                 nullptr);
  glEnable(GL_DEPTH_TEST);
  // Bodies come before the ground: its dearer pixels are then never shaded behind them.
  draw_bodies(meshes, list);
  if (ground) {
    glUseProgram(ground_program_);
    glBindVertexArray(ground_.array);
    glDrawElements(GL_TRIANGLES, ground_.index_count, GL_UNSIGNED_SHORT, nullptr);
  }
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  const auto shadow_count = static_cast<GLsizei>(list.shadows().size());
  if (shadow_count > 0) {
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(-1, -4);
    glUseProgram(shadow_program_);
    glBindVertexArray(shadow_array_);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, shadow_count);
    glDisable(GL_POLYGON_OFFSET_FILL);
  }
  if (wall_vertices_ > 0) {
    glUseProgram(wall_program_);
    glBindVertexArray(wall_array_);
    glDrawArrays(GL_TRIANGLES, 0, wall_vertices_);
  }
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

}  // namespace aureole::render
