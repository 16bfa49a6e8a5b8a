// The newest state of every body in the world, gathered from all regions, and where it is at any moment.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "protocol/frame.h"
#include "protocol/quantise.h"
#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"
#include "server/physics/body.h"

namespace aureole {

/// A body as it is drawn: poses lie on the world-wide quantisation grid, whichever way they came.
struct ReplicaPose {
  BodyId id;
  PrototypeId prototype;
  RegionId owner;
  bool asleep = false;
  WorldPosition position;
  Eigen::Quaternionf orientation{Eigen::Quaternionf::Identity()};
};

/// What a region says of a player whose avatar it owns.
struct ReplicaPlayer {
  PlayerId player;
  RegionId owner;
  std::uint32_t session = 0;
  std::uint32_t applied_sequence = 0;
  bool connected = false;
  BodyId carried;
};

/// Pure: no clock, no sockets. Versions decide: a state with a lower version than the one held is
/// never taken, so the order in which regions are heard does not matter. A body leaves the store only
/// when a region says that it was removed on purpose, with at least the version held.
class ReplicaStore {
 public:
  explicit ReplicaStore(std::size_t prototype_count) : prototype_count_(prototype_count) {}

  /// Takes in a replica_update payload of `from`. An Error (not a ReplicaUpdate, unknown prototype or
  /// slot, numbers that are not finite or out of range) means that the link must be closed; what came
  /// before the fault may have been taken.
  Status apply(RegionId from, std::span<const std::byte> payload);
  /// A (new) subscription begins: slots of `from` mean nothing any more, it is not complete.
  void region_up(RegionId from);
  void region_down(RegionId from);
  /// True once `from` has sent its whole state since region_up.
  bool is_complete(RegionId from) const;
  /// Newest tick heard of `from`, if any since region_up.
  std::optional<Tick> newest_tick(RegionId from) const;

  /// All bodies at world time `world_us`, ascending by id: interpolated between the two states
  /// around that moment, the newest one if it is later than all (never extrapolated).
  void sample(std::int64_t world_us, std::vector<ReplicaPose>& out) const;
  std::optional<ReplicaPose> sample_body(BodyId id, std::int64_t world_us) const;

  /// Newest exact state (from key states), for recovery and tests.
  struct KeyState {
    Version version;
    Tick tick;
    PrototypeId prototype;
    BodyState state;
  };
  std::optional<KeyState> key_state(BodyId id) const;
  std::optional<Version> version(BodyId id) const;

  std::size_t size() const;
  std::size_t awake_count() const;
  std::optional<ReplicaPlayer> player(PlayerId id) const;

 private:
  // The helper of this room decides (history of the last few poses for each body, slot tables).
  std::size_t prototype_count_;
};

}  // namespace aureole
