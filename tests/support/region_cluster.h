// Several region cores in one process, joined by an in-memory network that keeps TCP's contract.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/region/region_core.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole::testing {

/// A world with columns of `width` metres side by side from x = 0, flat ground, and one prototype
/// of each: 0 ball (r 0.3), 1 box (1×1×1), 2 plank, 3 avatar.
WorldDefinition flat_world(int columns, double width = 50);

/// Adds a body at rest or moving and returns its id.
BodyId put(WorldDefinition& world, PrototypeId prototype, WorldPosition at,
           Eigen::Vector3f velocity = {0, 0, 0}, Activation activation = Activation::awake);

inline constexpr PrototypeId ball{0}, box{1}, plank{2}, avatar_prototype{3};

class RegionCluster {
 public:
  /// Messages take `delay_ticks` whole ticks (0: they are there before the next step).
  /// `world` must outlive it.
  explicit RegionCluster(const WorldDefinition& world, int delay_ticks = 0);
  explicit RegionCluster(WorldDefinition&& world, int delay_ticks = 0) = delete;

  void step(int ticks = 1);
  Tick now() const { return now_; }
  RegionCore& core(int i) { return *cores_[static_cast<std::size_t>(i)]; }
  ReplicaStore& store() { return *store_; }

  /// Loses everything in flight between two regions and links them again.
  void reset_link(int a, int b);
  /// Loses everything in flight and takes the link down until reset_link.
  void cut_link(int a, int b);
  /// Kills a region and starts it with a new incarnation and an empty core.
  void restart(int i);

  /// From now on every region writes its snapshots to a disk that survives it.
  void give_disks();
  /// From now on what is due on the disk of a region is not written.
  void stop_disk(int i) { disk_stopped_[i] = true; }
  /// Ends the process of a region. What it has sent is lost, or still arrives.
  enum class Sent { lost, arrives };
  void kill(int i, Sent sent = Sent::lost);
  /// Starts it anew, from its disk or without one; it recovers.
  enum class Disk { kept, lost };
  Status start_again(int i, Disk disk = Disk::kept);
  bool is_alive(int i) const { return cores_[static_cast<std::size_t>(i)] != nullptr; }
  bool recovering() const;
  /// Ends the gateway's process, and starts an empty one that all regions know.
  void kill_store();
  void start_store();
  /// Messages from a to b wait from now on, although the link seems to be up.
  void silence(int a, int b) { silent_[{a, b}] = true; }
  Bytes& disk(int i) { return disks_[i]; }

  /// A player's command to the core that hosts the avatar now (or, for join, to region `to`).
  void command(PlayerCommand command, std::optional<int> to = {});

  /// The region that simulates the body; nothing if it is in flight. Fails the test if two do.
  std::optional<int> owner(BodyId id) const;
  /// Bodies hosted anywhere or travelling in a journal without a host.
  std::size_t bodies_in_world() const;
  BodyState state(BodyId id) const;
  /// Sentences of receive() errors; empty if all was well.
  const std::vector<std::string>& faults() const { return faults_; }

 private:
  struct Message {
    Tick arrives;
    SharedBytes frame;
  };
  void deliver();
  void hand_over(int from, int to, const SharedBytes& bytes);
  void collect();
  void take_of_store(int from, const SharedBytes& bytes);
  void write_disks();
  void link(int a, int b);

  const WorldDefinition& world_;
  int delay_ticks_;
  Tick now_;
  std::vector<std::unique_ptr<RegionCore>> cores_;
  std::vector<Incarnation> incarnations_;
  std::map<std::pair<int, int>, std::deque<Message>> links_;
  std::map<std::pair<int, int>, bool> cut_;
  std::map<std::pair<int, int>, bool> silent_;
  std::unique_ptr<ReplicaStore> store_;
  Incarnation store_incarnation_{1};
  std::map<int, std::deque<SharedBytes>> store_answers_;  ///< To regions, for the next tick.
  bool has_disks_ = false;
  std::map<int, Bytes> disks_;
  std::map<int, bool> disk_stopped_;
  std::vector<std::string> faults_;
};

}  // namespace aureole::testing
