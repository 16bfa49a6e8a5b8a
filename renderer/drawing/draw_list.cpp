// What one frame draws, gathered on the CPU: culled, grouped by mesh and level, in a fixed order.
#include "renderer/drawing/draw_list.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "renderer/drawing/culling.h"

namespace aureole::render {
namespace {

// Slots of one mesh among the bucket counters: the levels, then points.
constexpr std::uint32_t slots = level_count_max + 1;

// A blob smaller than this (pixels) is lost under its body.
constexpr float shadow_below_px = 16.0f;

// Everything that a frame could depend on; equal keys are told apart by their contents.
auto sort_tuple(const Instance& i) {
  return std::make_tuple(i.sort_key, i.mesh, i.position.x(), i.position.y(), i.position.z(),
                         i.orientation.x(), i.orientation.y(), i.orientation.z(), i.orientation.w(),
                         i.colour.r, i.colour.g, i.colour.b);
}

}  // namespace

void DrawList::order(std::span<const Instance> moving) {
  ordered_.clear();
  for (const Instance& i : moving) {
    // NaN would break the order; such an instance is left out here.
    if (i.position.allFinite() && i.orientation.allFinite())
      ordered_.push_back(&i);
    else
      ++hidden_;
  }
  // Whoever gathers bodies by id hands them over in order already.
  const auto out_of_order = std::adjacent_find(
      ordered_.begin(), ordered_.end(),
      [](const Instance* a, const Instance* b) { return a->sort_key >= b->sort_key; });
  if (out_of_order == ordered_.end()) return;
  std::sort(ordered_.begin(), ordered_.end(), [](const Instance* a, const Instance* b) {
    return a->sort_key != b->sort_key ? a->sort_key < b->sort_key : sort_tuple(*a) < sort_tuple(*b);
  });
}

void DrawList::gather(std::span<const Mesh> meshes, const Instance& instance, const View& view,
                      const Frustum& frustum, bool moves) {
  if (instance.mesh >= meshes.size() ||
      (view.hidden_key != 0 && instance.sort_key == view.hidden_key)) {
    ++hidden_;
    return;
  }
  const Mesh& mesh = meshes[instance.mesh];
  const Eigen::Vector3f relative = instance.position - view.camera.eye;
  const float norm = instance.orientation.norm();
  if (!frustum.sees(relative, mesh.bounding_radius) || norm < 1e-6f) {
    ++hidden_;
    return;
  }
  const float diameter_px = frustum.diameter_px(relative, mesh.bounding_radius);
  // Immovable things are few and often long and thin: never points.
  const int level = level_for(moves ? diameter_px : std::max(diameter_px, point_below_px),
                              static_cast<int>(mesh.levels.size()));
  const std::uint32_t slot = level < 0 ? slots - 1 : static_cast<std::uint32_t>(level);
  const std::uint32_t bucket = instance.mesh * slots + slot;
  ++counts_[bucket];
  const Eigen::Vector4f q = instance.orientation / norm;
  seen_.push_back({bucket,
                   {{relative.x(), relative.y(), relative.z()},
                    {q[0], q[1], q[2], q[3]},
                    {instance.colour.r, instance.colour.g, instance.colour.b, 255}}});
  if (moves && diameter_px >= shadow_below_px) casters_.push_back(&instance);
}

void DrawList::build(std::span<const Mesh> meshes, std::span<const Instance> fixed,
                     std::span<const Instance> moving, std::span<const ShadowReceiver> receivers,
                     const ShadowGround& ground, const View& view) {
  hidden_ = 0;
  seen_.clear();
  casters_.clear();
  counts_.assign(meshes.size() * slots, 0);
  order(moving);
  const Frustum frustum(view.camera, view.width, view.height);
  for (const Instance& i : fixed) gather(meshes, i, view, frustum, false);
  for (const Instance* i : ordered_) gather(meshes, *i, view, frustum, true);

  // A counting sort keeps the order inside each bucket.
  buckets_.clear();
  std::uint32_t first = 0;
  for (std::uint32_t bucket = 0; bucket < counts_.size(); ++bucket) {
    const std::uint32_t count = counts_[bucket];
    if (count > 0) {
      const std::uint32_t slot = bucket % slots;
      buckets_.push_back({static_cast<MeshIndex>(bucket / slots),
                          slot == slots - 1 ? -1 : static_cast<int>(slot), first, count});
    }
    counts_[bucket] = first;
    first += count;
  }
  instances_.resize(seen_.size());
  for (const Seen& s : seen_) instances_[counts_[s.bucket]++] = s.drawn;

  shadows_.clear();
  ShadowQuad quad{};
  for (const Instance* i : casters_) {
    if (cast_shadow(*i, meshes[i->mesh].half_extents, receivers, ground, view.camera.eye, quad))
      shadows_.push_back(quad);
  }
}

}  // namespace aureole::render
