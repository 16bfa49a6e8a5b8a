// Two region servers and a gateway in virtual time, whose messages can be looked at.
#pragma once

#include <memory>

#include "server/bench/bench.h"
#include "server/experiment/simulation.h"
#include "server/measure/measured/measured_run.h"

namespace aureole {

class RunningServers {
 public:
  explicit RunningServers(const BenchOptions& options);

  void tick() { simulation_->tick(); }
  void run(double seconds);

  int count() const { return count_; }
  const RegionCore& core(int server) const { return simulation_->server(server).core(); }
  /// Of the last tick.
  const StepProfile* profile(int server) const { return simulation_->server(server).profile(); }
  /// What the server sent in the last tick.
  std::span<const Outgoing> sent(int server) const { return core(server).outbox(); }

 private:
  int count_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace aureole
