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
  std::string where;                          ///< Of the worst: its tick, body and server.
  std::uint64_t handoffs = 0, stand_ins = 0;  ///< In the split world.
  /// Why the scene shows nothing although the numbers agree: something in it that was to take two
  /// servers took one. Empty if nothing is wrong.
  std::string idle;

  bool agrees() const { return worst <= limit; }
  bool held() const { return agrees() && idle.empty(); }
};

/// What broke, as a sentence with tick, body and server.
std::string describe(const Comparison& comparison);

/// Runs every scene twice, undivided and cut into 2 × 2 regions, without faults:
///  - ballistic flights through the corner and across every seam: distance at every tick;
///  - two-body collisions exactly on a seam and on the corner, straight and glancing: outgoing
///    velocities;
///  - Newton's cradle across a seam: the velocities of all its balls after the blow;
///  - dominoes across the corner: when each one falls, and that they fall in order;
///  - stacks that come to rest on a seam and on the corner: where each body ends.
/// Each scene also says whether it really took several servers: every flight crosses a boundary and
/// some go home there, who collides is brought together, rows and stacks lean on stand-ins or move.
std::vector<Comparison> compare_with_single_server(MigrationMode mode, NetworkTiming timing);

}  // namespace aureole
