// Region servers of a world in virtual time, with one gateway, as something that can be measured.
#pragma once

#include <functional>
#include <memory>

#include "server/experiment/simulation.h"
#include "server/measure/measured/measured_run.h"

namespace aureole {

/// Every server steps once at each tick's time, and its messages leave at once; the network's time
/// is virtual, a frame's is the thread's: what it took to read, decode, step, decide and encode.
/// Sockets and snapshots are not in it.
class RegionServers final : public MeasuredRun {
 public:
  struct Options {
    std::uint64_t seed = 1;
    NetworkTiming network{2000, 1000};
    StepProfile::Clocks clocks;   ///< None: frames take no time.
    bool judged = false;          ///< By the oracles, which costs more than the run.
    bool follow_latency = false;  ///< Else the world's tolerance stands.
    bool own_heaps = false;       ///< One for each server, as if it were a process.
    /// Before each frame, if there is any.
    std::function<void()> before_frame;
  };
  RegionServers(WorldDefinition world, const Options& options);

  void tick() override;
  const std::vector<FrameTime>& frames() const override { return frames_; }
  std::vector<ServerLoad> loads() const override;
  std::optional<Outside> outside_tolerances() const override;
  std::optional<double> latency_tolerance_ms() const override;
  std::uint64_t migrations() const override;
  std::vector<LinkTraffic> traffic() const override;
  std::uint64_t state_hash() const override;
  std::uint64_t refused_messages() const override;

  const Simulation& simulation() const { return *simulation_; }
  Simulation& simulation() { return *simulation_; }

 private:
  /// Reads only: the simulation's accessors are those of tests, which step through it.
  Simulation& servers() const { return *simulation_; }
  int count_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<FrameTime> frames_;
};

}  // namespace aureole
