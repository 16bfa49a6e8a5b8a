// Which immovable geometry a moving body may meet soon, roughly and quickly.
#pragma once

#include <span>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/shapes/aura_box.h"
#include "server/physics/body.h"

namespace aureole {

/// Planes and boxes around everything else; made once.
class NearbyGeometry {
 public:
  explicit NearbyGeometry(std::span<const StaticDefinition> statics);

  /// Sets ground_gap_m, and near_geometry of what moves, by what the body can reach within
  /// `reach_s`.
  void look(HostedBody& body, double reach_s) const;

 private:
  std::vector<double> planes_y_;  ///< Heights of planes (m); they are level.
  std::vector<AuraBox> boxes_;
};

}  // namespace aureole
