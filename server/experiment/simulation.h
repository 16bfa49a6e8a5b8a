// One seed: the production cores under a simulated network, faults first and calm afterwards, with
// every rule looked at every tick.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/experiment/network/fault_plan.h"
#include "server/experiment/network/simulated_network.h"
#include "server/experiment/oracles/handoff_shadow.h"
#include "server/experiment/oracles/oracle_interactions.h"
#include "server/experiment/oracles/oracle_ownership.h"
#include "server/experiment/oracles/tolerance_record.h"
#include "server/experiment/oracles/view/world_view.h"
#include "server/experiment/scenario/scenario.h"
#include "server/experiment/seed_result.h"
#include "server/experiment/simulated/simulated_gateway.h"
#include "server/experiment/simulated/simulated_players.h"
#include "server/experiment/simulated/simulated_server.h"

namespace aureole {

struct SimulationOptions {
  ScenarioOptions scenario;
  NetworkTiming network{2000, 1000};
  FaultKinds faults = FaultKinds::none;
  SimulatedPace pace;
  /// Without it nobody looks at the run: no oracles, no hash. What happens is the same.
  bool judged = true;
  /// Keep the hash of each step, so that two runs can be compared step by step.
  bool keep_trail = false;
};

/// Runs a scenario to its end. Deterministic: the same options give the same hash.
class Simulation {
 public:
  /// Faults stop at this share of the run's time; then everything must settle.
  static constexpr double faults_share = 0.6;
  /// After the run's time it waits so long (virtual) for everything to fall asleep. Lines that have
  /// moved take five terms of it (home_lines.h) to come back, and then things go home.
  static constexpr double calm_extension_s = 40;
  /// How far 99 % of the handoffs may move a body at most, without faults and within tolerances.
  static constexpr double jump_mm_p99_max = 5;

  Simulation(Scenario scenario, const SimulationOptions& options);
  ~Simulation();

  SeedResult run();

  // For tests, which step through a scenario by themselves.
  /// Takes the world on by a tick, with all that the oracles look at.
  void tick();
  Tick now() const { return now_; }
  SimulatedServer& server(int region) { return servers_[static_cast<std::size_t>(region)]; }
  SimulatedNetwork& network() { return network_; }
  const InteractionOracle& interactions() const { return interactions_; }
  const OwnershipOracle& ownership() const { return ownership_; }
  HandoffShadow& shadow() { return shadow_; }
  const std::vector<SeenBody>& seen() const { return seen_; }
  const SimulatedGateway& gateway() const { return gateway_; }
  /// kill -9; it starts again after that time, or never.
  void kill(End who, bool lose_disk, std::optional<Micros> back_after_us);
  /// Judges the end and reports.
  SeedResult finish();

 private:
  void run_until(Micros until);
  void begin_faults(Micros now);
  void inject(const Fault& fault, Micros now);
  void after_step(SimulatedServer& server, const SimulatedServer::Step& step);
  void note_tolerances(Micros now);
  void note_lines();
  void look();
  void judge_rest();
  void judge_jumps();
  bool pours() const;
  bool all_run() const;
  bool all_rest();
  bool players_act(Micros now) const;

  Scenario scenario_;
  SimulationOptions options_;
  std::vector<Fault> faults_;
  std::size_t next_fault_ = 0;
  Micros faults_until_us_ = 0;
  Tick end_;
  SimulatedNetwork network_;
  std::vector<SimulatedServer> servers_;
  SimulatedGateway gateway_;
  SimulatedPlayers players_;
  struct Restart {
    Micros at_us;
    End who;
  };
  std::vector<Restart> restarts_;
  PartitionMap map_;
  ToleranceRecord tolerances_;
  WorldView view_;
  OwnershipOracle ownership_;
  InteractionOracle interactions_;
  HandoffShadow shadow_;
  std::vector<SeenBody> seen_;                ///< At the tick that was looked at last.
  std::vector<std::uint64_t> events_;         ///< Of each server's present core.
  std::vector<std::uint64_t> line_versions_;  ///< Of each server's map of homes.
  SeedResult result_;
  Tick stirred_;                  ///< When anything was last awake, from the end of the run on.
  Tick lines_moved_{-1'000'000};  ///< When any server's map of homes last changed.
  Tick now_;
  Micros virtual_us_ = 0;  ///< Of the event at hand.
};

/// Makes the scenario of the options and runs it. Errors: those of make_scenario.
Result<SeedResult> simulate(const SimulationOptions& options);

}  // namespace aureole
