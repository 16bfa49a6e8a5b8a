// Boxes around static geometry against the way of a body.
#include "server/region/view/nearby_geometry.h"

#include <algorithm>

#include "server/aura/adaptive/outlook/aura_size.h"

namespace aureole {

NearbyGeometry::NearbyGeometry(std::span<const StaticDefinition> statics) {
  for (const StaticDefinition& piece : statics) {
    if (std::holds_alternative<PlaneShape>(piece.shape)) {
      planes_y_.push_back(piece.position.y);
      continue;
    }
    const double radius = bounding_radius(piece.shape);
    boxes_.push_back({piece.position.vector(), Eigen::Vector3d::Constant(radius)});
  }
}

void NearbyGeometry::look(HostedBody& body, double reach_s) const {
  const AuraBox way = way_of(body, reach_s);
  const double low = way.centre.y() - way.half.y();
  body.ground_gap_m = std::numeric_limits<double>::infinity();
  const double lowest = body.position.y - body.half_extents.y();
  for (const double y : planes_y_)
    if (low <= y) body.ground_gap_m = std::min(body.ground_gap_m, std::max(0.0, lowest - y));
  body.near_geometry =
      body.still_ticks == 0 && std::any_of(boxes_.begin(), boxes_.end(),
                                           [&](const AuraBox& box) { return box.overlaps(way); });
}

}  // namespace aureole
