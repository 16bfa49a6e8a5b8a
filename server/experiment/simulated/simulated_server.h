// A region's process in virtual time: the production core, a modelled frame time, and a disk.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "server/experiment/network/simulated_network.h"
#include "server/experiment/random.h"
#include "server/experiment/server_thread.h"
#include "server/region/region_core.h"

namespace aureole {

/// How a simulated process keeps time.
struct SimulatedPace {
  /// Steps are taken at their tick's time and are over at once; otherwise they are drawn, as late
  /// and as long as tolerances allow.
  bool even = false;
  bool snapshots = true;
  /// Null: steps are not profiled.
  StepProfile::Clocks clocks;
  /// The latency tolerance follows what links measure.
  bool follow_latency = false;
  /// Each server has a heap of its own (ServerThread).
  bool own_heaps = false;
  /// Before a server does anything that is profiled, if there is any.
  std::function<void()> before_frame = {};
  /// From so many bodies awake on servers are ordered by their loads.
  double level_from = LoadLevels::awake_min;
  /// See RegionCore::level_from().
  std::optional<double> crowd_share = {};
};

/// Does what server/net/region_server.cpp does, without sockets and clocks: at most two steps in
/// the time of one when it is behind, and past 8 ticks it leaves ticks out.
class SimulatedServer {
 public:
  /// One step: of which tick, when it began and when it was over (its messages leave then).
  struct Step {
    Tick tick;
    Micros began_us = 0, ended_us = 0;
  };
  /// Called after each step, while the outbox is still there.
  using Observer = std::function<void(SimulatedServer&, const Step&)>;

  SimulatedServer(const WorldDefinition& world, RegionId self, std::uint64_t seed,
                  SimulatedPace pace = {});

  void start(SimulatedNetwork& network, Micros now);
  /// kill -9: everything but the disk is gone.
  void crash(SimulatedNetwork& network, Micros now, bool lose_disk);
  /// Its frames take so long until then.
  void slow_down(double frame_ms, Micros until);

  /// When it wants to run next; `never` while it is down.
  Micros wakes_at() const { return core_ ? wakes_at_us_ : never; }
  void wake(SimulatedNetwork& network, Micros now, const Observer& observer);

  RegionId self() const { return self_; }
  bool runs() const { return core_ != nullptr; }
  const RegionCore& core() const { return *core_; }
  RegionCore& core() { return *core_; }
  Incarnation incarnation() const { return incarnation_; }
  bool is_recovering() const { return core_ && core_->recovering(); }
  Tick last_tick() const { return next_tick_ - 1; }
  std::uint64_t skipped_ticks() const { return skipped_ticks_; }
  /// What the core refused and why: honest peers are never refused.
  const std::vector<std::string>& refusals() const { return refusals_; }
  /// What was spent since it woke last, without the network; null unless steps are profiled.
  const StepProfile* profile() const { return profile_.get(); }

 private:
  void take_turn(SimulatedNetwork& network, Micros now, const Observer& observer);
  void step(SimulatedNetwork& network, Micros at, const Observer& observer);
  void take_deliveries(SimulatedNetwork& network, Micros now);
  double draw_frame_ms(Micros at);
  void write_disk(Tick tick);
  void finish_write();

  /// On its own thread, if it has one.
  void run(const std::function<void()>& work) { thread_ ? thread_->run(work) : work(); }

  const WorldDefinition& world_;
  RegionId self_;
  Incarnation incarnation_;
  Random random_;
  std::unique_ptr<ServerThread> thread_;
  std::unique_ptr<RegionCore> core_;
  Tick next_tick_{1};
  Micros wakes_at_us_ = 0;
  Micros step_ended_us_ = 0;
  Micros phase_us_ = 0;  ///< Of its clock against world time.
  Micros load_until_us_ = 0;
  bool busy_ = false;
  double last_frame_ms_ = 0;
  double slow_frame_ms_ = 0;
  Micros slow_until_us_ = 0;
  std::uint64_t skipped_ticks_ = 0;
  SimulatedPace pace_;
  std::unique_ptr<StepProfile> profile_;
  struct Disk {
    std::shared_ptr<const Bytes> written;  ///< What survives.
    std::shared_ptr<const Bytes> writing;  ///< Complete one step later.
    Tick writing_tick;
  };
  Disk disk_;
  std::vector<std::string> refusals_;
};

}  // namespace aureole
