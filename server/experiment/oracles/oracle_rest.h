// Rule 5: after the faults and some calm everything sleeps on the server whose region it lies in,
// as the lines are then (home_lines.h), and nothing changes its owner any more.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/experiment/oracles/owner_changes.h"
#include "server/experiment/seed_result.h"
#include "server/experiment/simulated/simulated_server.h"

namespace aureole {

/// The end of a run, looked at body by body. Still being in motion is no broken rule: a heap that a
/// player stands in creeps for a minute, a ball may roll for as long. What is awake (avatars always
/// are, they do not count), what is near to it, and what hangs together with that, is left out and
/// counted; everything else must be asleep at home, whoever else is awake elsewhere. (Only
/// `adaptive` sends home what sleeps; in the other modes it only must not change its owner any
/// more.)
class RestOracle {
 public:
  /// How far outside of its server's region a body may rest (m): the hysteresis of going home.
  static constexpr double away_m_max = 0.5;
  /// What is so near to something awake may be held together with it (m, between surfaces).
  static constexpr double near_m = 2;

  explicit RestOracle(const WorldDefinition& world);

  /// `late`: changes of owner in the last second.
  void judge(Tick now, std::span<const SimulatedServer> servers, std::span<const OwnerChange> late);

  /// Instead, while lines move and things follow them: leaves out all that is asleep.
  void leave_out_all(std::span<const SimulatedServer> servers);

  /// Adds unsettled, awake_at_end and what is to be said of them.
  void report(SeedResult& result) const;

 private:
  struct Body {
    BodyId id;
    RegionId owner;
    WorldPosition at;
    double away_m = 0;  ///< Outside of its server's region.
    double radius_m = 0;
    bool awake = false, left_out = false;
  };
  void gather(std::span<const SimulatedServer> servers);
  void leave_out_what_stirs();
  void violate(Tick tick, std::string what);

  bool goes_home_;
  std::vector<double> radii_;  ///< Of the prototypes.
  std::vector<Body> bodies_;
  std::vector<Violation> violations_;
  std::uint64_t unsettled_ = 0, awake_ = 0, left_out_ = 0;
};

}  // namespace aureole
