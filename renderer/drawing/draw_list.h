// What one frame draws, gathered on the CPU: culled, grouped by mesh and level, in a fixed order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/drawing/shadows.h"
#include "renderer/mesh/mesh.h"
#include "renderer/scene.h"

namespace aureole::render {

/// 32 bytes, as the vertex shader reads it; the position is relative to the eye (m).
struct DrawnInstance {
  float position[3];
  float orientation[4];  ///< x, y, z, w
  std::uint8_t colour[4];
};
static_assert(sizeof(DrawnInstance) == 32);

/// Instances `first` … `first + count - 1` of one mesh at one level of detail (-1: as points).
struct DrawBucket {
  MeshIndex mesh = 0;
  int level = 0;
  std::uint32_t first = 0, count = 0;
};

/// Buffers are kept from frame to frame.
class DrawList {
 public:
  /// Gathers what `view` sees of both spans. The order of `moving` does not matter. Bodies get
  /// shadows, static instances do not. Leaves out what cannot be drawn (see Renderer::render).
  void build(std::span<const Mesh> meshes, std::span<const Instance> fixed,
             std::span<const Instance> moving, std::span<const ShadowReceiver> receivers,
             const ShadowGround& ground, const View& view);

  std::span<const DrawnInstance> instances() const { return instances_; }
  /// Ordered by mesh, then level; none is empty.
  std::span<const DrawBucket> buckets() const { return buckets_; }
  std::span<const ShadowQuad> shadows() const { return shadows_; }
  int hidden() const { return hidden_; }

 private:
  struct Seen {
    std::uint32_t bucket;
    DrawnInstance drawn;
  };
  void gather(std::span<const Mesh> meshes, const Instance& instance, const View& view,
              const class Frustum& frustum, bool moves);
  void order(std::span<const Instance> moving);

  std::vector<Seen> seen_;
  std::vector<const Instance*> ordered_;
  std::vector<const Instance*> casters_;
  std::vector<std::uint32_t> counts_;
  std::vector<DrawnInstance> instances_;
  std::vector<DrawBucket> buckets_;
  std::vector<ShadowQuad> shadows_;
  int hidden_ = 0;
};

}  // namespace aureole::render
