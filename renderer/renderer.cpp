// Draws a Scene as one View sees it, into memory.
#include "renderer/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>

#include "renderer/drawing/culling.h"
#include "renderer/drawing/draw_list.h"
#include "renderer/gl/gpu_geometry.h"
#include "renderer/gl/render_targets.h"
#include "renderer/gl/shaders.h"

namespace aureole::render {
namespace {

constexpr float ground_reach_m = 590.0f;
constexpr float fog_density = 1.0f / 150.0f;
// Everything in the ground's pattern repeats after this (m); the eye's place is taken modulo it.
constexpr double ground_period_m = 20.0;

double clock_ms(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

// Splits a frame's time into phases.
class Stopwatch {
 public:
  FrameTimings::Phase lap() {
    const Stopwatch now;
    const FrameTimings::Phase phase{now.wall_ms_ - wall_ms_, now.cpu_ms_ - cpu_ms_};
    *this = now;
    return phase;
  }

 private:
  double wall_ms_ = clock_ms(CLOCK_MONOTONIC);
  double cpu_ms_ = clock_ms(CLOCK_THREAD_CPUTIME_ID);
};

View within_range(View view) {
  view.width = std::clamp(view.width, 16, 3840);
  view.height = std::clamp(view.height, 16, 2160);
  return view;
}

FrameUniforms frame_uniforms(const View& view, const StaticGeometry& geometry) {
  FrameUniforms u{};
  const Eigen::Matrix4f m = view_projection(view.camera, view.width, view.height);
  std::copy(m.data(), m.data() + 16, u.view_projection);
  const auto& eye = view.camera.eye;
  u.ground_height = geometry.ground_height_m - eye.y();
  u.pixels_per_unit =
      static_cast<float>(view.height) / 2 / std::tan(view.camera.vertical_fov_rad / 2);
  u.fog_density = fog_density;
  u.grid_origin[0] = static_cast<float>(std::fmod(static_cast<double>(eye.x()), ground_period_m));
  u.grid_origin[1] = static_cast<float>(std::fmod(static_cast<double>(eye.z()), ground_period_m));
  u.ground_colour[0] = static_cast<float>(geometry.ground_colour.r) / 255;
  u.ground_colour[1] = static_cast<float>(geometry.ground_colour.g) / 255;
  u.ground_colour[2] = static_cast<float>(geometry.ground_colour.b) / 255;
  u.ground_colour[3] = 1;
  return u;
}

}  // namespace

struct Renderer::State {
  std::unique_ptr<OffscreenContext> context;
  std::vector<MeshDescription> descriptions;
  std::vector<Mesh> meshes;
  StaticGeometry geometry;
  std::vector<ShadowReceiver> receivers;
  GpuGeometry gpu;
  RenderTargets targets;
  DrawList list;
  std::vector<WallVertex> walls;
  Pixels pixels;
  FrameTimings timings;
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

Outcome<std::unique_ptr<Renderer>> Renderer::make(std::unique_ptr<OffscreenContext> context,
                                                  std::span<const MeshDescription> meshes,
                                                  const StaticGeometry& geometry) {
  check(context != nullptr, "a renderer is made with a context");
  check(meshes.size() < 65536, "a mesh index fits into 16 bits");
  if (!context->make_current())
    return Failure{"the OpenGL context cannot be made current in this thread"};
  auto state = std::make_unique<State>();
  state->context = std::move(context);
  state->descriptions.assign(meshes.begin(), meshes.end());
  for (const MeshDescription& description : meshes) state->meshes.push_back(make_mesh(description));
  const auto uploaded = state->gpu.upload(state->meshes, ground_reach_m);
  if (!uploaded) return uploaded.failure();
  auto renderer = std::unique_ptr<Renderer>(new Renderer(std::move(state)));
  renderer->set_static(geometry);
  return renderer;
}

void Renderer::set_static(const StaticGeometry& geometry) {
  State& s = *state_;
  s.geometry = geometry;
  std::erase_if(s.geometry.instances, [&](const Instance& i) {
    return i.mesh >= s.meshes.size() || !i.position.allFinite() || !i.orientation.allFinite();
  });
  std::stable_sort(s.geometry.instances.begin(), s.geometry.instances.end(),
                   [](const Instance& a, const Instance& b) { return a.sort_key < b.sort_key; });
  s.receivers.clear();
  for (const Instance& i : s.geometry.instances) {
    if (const auto* box = std::get_if<BoxShape>(&s.descriptions[i.mesh].shape))
      s.receivers.push_back(upper_face(*box, i));
  }
}

const Pixels& Renderer::render(const Scene& scene, const View& asked) {
  State& s = *state_;
  Stopwatch watch;
  check(s.context->make_current(), "a renderer's context can be made current where it renders");
  const View view = within_range(asked);
  const ShadowGround ground{s.geometry.has_ground, s.geometry.ground_height_m};
  s.list.build(s.meshes, s.geometry.instances, scene.instances, s.receivers, ground, view);
  s.walls.clear();
  if (view.show_boundaries) {
    build_walls(scene.boundaries, view.camera.eye, s.geometry.ground_height_m, view.camera.far_m,
                s.walls);
  }
  s.gpu.begin_frame(frame_uniforms(view, s.geometry), s.list, s.walls);
  s.timings = {};
  s.timings.prepare = watch.lap();

  s.targets.bind(view.width, view.height);
  s.gpu.draw(s.meshes, s.list, s.geometry.has_ground);
  s.timings.submit = watch.lap();

  s.targets.read(s.pixels);
  s.timings.finish = watch.lap();
  for (const DrawBucket& b : s.list.buckets()) {
    (b.level < 0 ? s.timings.bodies_as_points : s.timings.bodies_as_triangles) +=
        static_cast<int>(b.count);
  }
  s.timings.bodies_hidden = s.list.hidden();
  s.timings.shadows = static_cast<int>(s.list.shadows().size());
  return s.pixels;
}

const FrameTimings& Renderer::timings() const {
  return state_->timings;
}
const OffscreenContext& Renderer::context() const {
  return *state_->context;
}
const Mesh& Renderer::mesh(MeshIndex index) const {
  check(index < state_->meshes.size(), "a mesh index lies inside the renderer's table");
  return state_->meshes[index];
}

}  // namespace aureole::render
