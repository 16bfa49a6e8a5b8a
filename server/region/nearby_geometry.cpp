// Boxes around static geometry against the way of a body.
#include "server/region/nearby_geometry.h"

#include <algorithm>

#include "server/aura/adaptive/aura_size.h"

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
  const AuraBox way = flight_aura(body, reach_s);
  const double low = way.centre.y() - way.half.y();
  body.near_ground =
      std::any_of(planes_y_.begin(), planes_y_.end(), [&](double y) { return low <= y; });
  body.near_geometry = std::any_of(boxes_.begin(), boxes_.end(),
                                   [&](const AuraBox& box) { return box.overlaps(way); });
}

}  // namespace aureole
