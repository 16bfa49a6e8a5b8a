// The world at one moment: sampled once, built into a scene once, shared by every view that shows
// it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/gateway/pictures/render_pool.h"
#include "server/gateway/pictures/scene_builder.h"
#include "server/gateway/region_subscriber.h"

namespace aureole {

struct Moment {
  std::int64_t world_us = 0;
  std::vector<ReplicaPose> poses;  ///< Ascending by id.
  std::vector<render::BoundaryLine> boundaries;
  /// Plain and tinted by region; made when first asked for.
  mutable std::array<SharedScene, 2> scenes;

  const ReplicaPose* find(BodyId id) const;
};
using SharedMoment = std::shared_ptr<const Moment>;

class Moments {
 public:
  /// All must outlive it.
  Moments(RegionSubscriber& regions, const SceneBuilder& builder, const WorldDefinition& world)
      : regions_(regions), builder_(builder), world_(world) {}

  /// The moment to draw at local time `local_us`: the last one if that is not older than
  /// `reuse_us`. Null until a region has been heard.
  SharedMoment at(std::int64_t local_us);
  SharedScene scene(const Moment& moment, bool tinted) const;

  /// Views that are late within one drawing interval still share what others draw.
  static constexpr std::int64_t reuse_us = 4'000;

 private:
  RegionSubscriber& regions_;
  const SceneBuilder& builder_;
  const WorldDefinition& world_;
  SharedMoment last_;
  std::int64_t last_local_us_ = 0;
};

}  // namespace aureole
