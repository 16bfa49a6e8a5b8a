// Sampling the replica store for pictures.
#include "server/gateway/pictures/moments.h"

#include <algorithm>
#include <utility>

namespace aureole {

const ReplicaPose* Moment::find(BodyId id) const {
  const auto at =
      std::lower_bound(poses.begin(), poses.end(), id,
                       [](const ReplicaPose& pose, BodyId wanted) { return pose.id < wanted; });
  return at != poses.end() && at->id == id ? &*at : nullptr;
}

SharedMoment Moments::at(std::int64_t local_us) {
  if (last_ && local_us - last_local_us_ < reuse_us) return last_;
  const auto world_us = regions_.draw_us(local_us);
  if (!world_us) return nullptr;
  auto moment = std::make_shared<Moment>();
  moment->world_us = *world_us;
  if (last_) moment->poses.reserve(last_->poses.size() + 16);
  regions_.store().sample(*world_us, moment->poses);
  moment->boundaries = boundary_lines(regions_.map_at(*world_us), world_.bounds);
  last_ = std::move(moment);
  last_local_us_ = local_us;
  return last_;
}

SharedScene Moments::scene(const Moment& moment, bool tinted) const {
  SharedScene& scene = moment.scenes[tinted ? 1 : 0];
  if (scene) return scene;
  render::Scene built = builder_.build(moment.poses, tinted);
  built.boundaries = moment.boundaries;
  return scene = std::make_shared<const render::Scene>(std::move(built));
}

}  // namespace aureole
