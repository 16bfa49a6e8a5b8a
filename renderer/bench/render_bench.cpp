// How long frames take to draw and encode, and how large they are.
#include "renderer/bench/render_bench.h"

#include <algorithm>
#include <ctime>

#include "renderer/bench/demo_scene.h"
#include "renderer/jpeg_encoder.h"
#include "renderer/renderer.h"

namespace aureole::render {
namespace {

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

template <class T>
T median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Outcome<RenderBenchResult> run_one(int bodies, const RenderBenchOptions& options) {
  auto context = make_osmesa_context();
  if (!context) return context.failure();
  const DemoScene demo = make_demo_scene(bodies);
  auto renderer = Renderer::make(std::move(*context), demo.meshes, demo.geometry);
  if (!renderer) return renderer.failure();
  JpegEncoder encoder;
  View view;
  view.width = options.width;
  view.height = options.height;
  view.show_boundaries = options.show_boundaries;

  std::vector<double> wall, cpu, prepare, submit, finish, encode;
  std::vector<std::size_t> bytes;
  const int frames = std::max(1, options.frames), warm_up = frames / 10;
  for (int frame = 0; frame < warm_up + frames; ++frame) {
    view.camera = demo_walk(frame);
    const Pixels& pixels = (*renderer)->render(demo.scene, view);
    const double before_ms = cpu_ms();
    const auto jpeg = encoder.encode(pixels, options.quality);
    if (!jpeg) return jpeg.failure();
    if (frame < warm_up) continue;
    encode.push_back(cpu_ms() - before_ms);
    bytes.push_back(jpeg->size());
    const FrameTimings& t = (*renderer)->timings();
    wall.push_back(t.wall_ms());
    cpu.push_back(t.cpu_ms());
    prepare.push_back(t.prepare.cpu_ms);
    submit.push_back(t.submit.cpu_ms);
    finish.push_back(t.finish.cpu_ms);
  }
  const FrameTimings& last = (*renderer)->timings();
  return RenderBenchResult{static_cast<int>(demo.scene.instances.size()),
                           options.width,
                           options.height,
                           options.quality,
                           median(wall),
                           median(cpu),
                           median(prepare),
                           median(submit),
                           median(finish),
                           median(encode),
                           median(bytes),
                           last.bodies_as_triangles,
                           last.bodies_as_points,
                           last.shadows};
}

}  // namespace

Outcome<std::vector<RenderBenchResult>> run_render_bench(const RenderBenchOptions& options) {
  std::vector<RenderBenchResult> results;
  for (const int bodies : options.bodies) {
    const auto result = run_one(bodies, options);
    if (!result) return result.failure();
    results.push_back(*result);
  }
  return results;
}

}  // namespace aureole::render
