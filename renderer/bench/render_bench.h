// How long frames take to draw and encode, and how large they are.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/outcome.h"

namespace aureole::render {

struct RenderBenchOptions {
  std::vector<int> bodies{500, 2000, 10000};
  int width = 1280, height = 720;
  int frames =
      240;  ///< Measured frames for each number of bodies, after a tenth as many to warm up.
  int quality = 75;
  bool show_boundaries = false;
};

/// Medians over the measured frames.
struct RenderBenchResult {
  int bodies = 0, width = 0, height = 0, quality = 0;
  double render_wall_ms = 0, render_cpu_ms = 0;
  double prepare_cpu_ms = 0, submit_cpu_ms = 0, finish_cpu_ms = 0;
  double encode_cpu_ms = 0;
  std::size_t bytes_per_frame = 0;
  int as_triangles = 0, as_points = 0, shadows = 0;  ///< Of the last frame.
};

/// Walks a camera around the demo scene with each of the given numbers of bodies, in this thread,
/// with software rasterising. CPU times are this thread's: call configure_software_rasteriser(0)
/// first to have all work in them.
Outcome<std::vector<RenderBenchResult>> run_render_bench(const RenderBenchOptions& options);

}  // namespace aureole::render
