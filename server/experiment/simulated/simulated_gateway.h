// A gateway's process in virtual time: a replica store that hears every region, and the players'
// command streams.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/experiment/network/simulated_network.h"
#include "server/replica/replica_store.h"
#include "server/worlds/world.h"

namespace aureole {

class SimulatedGateway {
 public:
  /// A gateway looks at what arrived this often.
  static constexpr Micros interval_us = 4000;

  SimulatedGateway(const WorldDefinition& world, std::size_t regions);

  void start(SimulatedNetwork& network, Micros now);
  void crash(SimulatedNetwork& network, Micros now);

  Micros wakes_at() const { return store_ ? wakes_at_us_ : never; }
  void wake(SimulatedNetwork& network, Micros now);

  bool runs() const { return store_ != nullptr; }
  const ReplicaStore& store() const { return *store_; }
  /// Sends a frame to a region, as far as that is linked.
  void send(SimulatedNetwork& network, RegionId to, SharedBytes frame, Micros now);
  bool is_linked(RegionId region) const { return linked_[region.value]; }
  /// Grows with every start.
  Incarnation incarnation() const { return incarnation_; }
  const std::vector<std::string>& refusals() const { return refusals_; }

 private:
  /// Tells a region in recovery what the store knows.
  Status answer(SimulatedNetwork& network, RegionId from, const FrameView& query, Micros now);
  void take(SimulatedNetwork& network, const Delivery& delivery, Micros now);

  const WorldDefinition& world_;
  End self_;
  Incarnation incarnation_;
  std::unique_ptr<ReplicaStore> store_;
  std::vector<bool> linked_;
  Micros wakes_at_us_ = 0;
  std::vector<std::string> refusals_;
};

}  // namespace aureole
