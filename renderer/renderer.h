// Draws a Scene as one View sees it, into memory.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderer/gl/offscreen_context.h"
#include "renderer/mesh/mesh.h"
#include "renderer/outcome.h"
#include "renderer/pixels.h"
#include "renderer/scene.h"

namespace aureole::render {

/// What never moves.
struct StaticGeometry {
  std::vector<Instance> instances;  ///< Ramps, platforms, walls; boxes among them receive shadows.
  bool has_ground = true;
  float ground_height_m = 0;
  Rgb ground_colour{136, 156, 140};
};

/// Where one frame's time went (unit: ms). CPU is this thread's alone: rasterising by llvmpipe's
/// helper threads shows in the wall time of `finish`.
struct FrameTimings {
  struct Phase {
    double wall_ms = 0, cpu_ms = 0;
  };
  Phase prepare;  ///< Culling, levels of detail, shadows, upload.
  Phase submit;   ///< Draw calls; llvmpipe runs vertex shaders and bins triangles here.
  Phase finish;   ///< Rasterising and copying the frame out.
  /// Static instances count as bodies here.
  int bodies_as_triangles = 0, bodies_as_points = 0, bodies_hidden = 0, shadows = 0;
  double wall_ms() const { return prepare.wall_ms + submit.wall_ms + finish.wall_ms; }
  double cpu_ms() const { return prepare.cpu_ms + submit.cpu_ms + finish.cpu_ms; }
};

/// One renderer belongs to one thread at a time (the thread that renders may change between frames
/// only if the earlier one does not render anything else in between). Several renderers can work in
/// several threads of a process. Nothing here depends on time or chance: equal scenes and views
/// give equal bytes, in whatever order the instances come.
class Renderer {
 public:
  /// `Instance::mesh` indexes `meshes`. Fails if the context or its shaders do.
  static Outcome<std::unique_ptr<Renderer>> make(std::unique_ptr<OffscreenContext> context,
                                                 std::span<const MeshDescription> meshes,
                                                 const StaticGeometry& geometry = {});
  ~Renderer();

  /// Replaces the static geometry.
  void set_static(const StaticGeometry& geometry);

  /// Draws a frame. The pixels stay valid until the next call. Instances with an unknown mesh, or
  /// with a position or orientation that is not finite, are left out; a size outside View's range
  /// is brought into it. A driver without memory for the frame ends the process, as `new` would.
  const Pixels& render(const Scene& scene, const View& view);

  /// Of the last frame.
  const FrameTimings& timings() const;
  const OffscreenContext& context() const;
  /// The table's mesh as it is drawn.
  const Mesh& mesh(MeshIndex index) const;

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace aureole::render
