// The second oracle: the same scene on one server and on several must come to the same.
#pragma once

#include <string>
#include <vector>

#include "server/aura/migration_mode.h"
#include "server/experiment/network/simulated_network.h"
#include "server/experiment/seed_result.h"

namespace aureole {

/// One scene: how far the split world was from the undivided one at worst, and what is allowed.
struct Comparison {
  std::string scene;
  std::string measure;  ///< What the numbers are, with the unit.
  double worst = 0;
  double limit = 0;
  bool held() const { return worst <= limit; }
};

/// Runs every scene twice, undivided and cut into 2 × 2 regions, without faults:
///  - ballistic flights across seams and through the corner: distance at every tick;
///  - two-body collisions exactly on a seam and on the corner, straight and glancing: outgoing
///    velocities;
///  - Newton's cradle across a seam: the velocities of all its balls after the blow;
///  - dominoes across the corner: when each one falls, and that they fall in order;
///  - stacks that come to rest on a seam and on the corner: where each body ends.
std::vector<Comparison> compare_with_single_server(MigrationMode mode, NetworkTiming timing);

}  // namespace aureole
