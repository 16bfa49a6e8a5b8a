// What changes its server and why: one small interface, one implementation for each mode.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/aura/partition_map.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/base/world_position.h"

namespace aureole {

/// What a policy knows of each body that its server hosts.
struct HostedBody {
  BodyId id;
  WorldPosition position;
  bool asleep = false;
  /// The body that this one must be hosted with (a carried thing with the avatar); none: decides itself.
  BodyId leader;
  /// When it last changed its owner.
  Tick changed_owner;
};

/// A group that goes to one server together.
struct Migration {
  RegionId to;
  std::vector<BodyId> bodies;  ///< ascending
};

class MigrationPolicy {
 public:
  virtual ~MigrationPolicy() = default;
  /// Decides after step `now` which of `hosted` (ascending by id) leave `self`. Groups are disjoint
  /// and come in ascending order of their destination.
  virtual std::vector<Migration> decide(Tick now, RegionId self, const PartitionMap& map,
                                        std::span<const HostedBody> hosted) = 0;
};

/// Section 3.1 of the paper: a body is handed over when its centre has crossed the boundary. Bodies
/// that cross in the same step to the same region travel as one group, so that a sleeping stack goes
/// whole. Against thrash a centre must be `naive_hysteresis_m` across, and a body stays at least
/// `naive_stay_ticks` with each owner.
std::unique_ptr<MigrationPolicy> make_naive_policy();

/// Far enough that a body resting on the line does not flicker; near enough not to be seen (m).
inline constexpr double naive_hysteresis_m = 0.05;
/// Half a second: at most two changes of owner in any second.
inline constexpr std::int64_t naive_stay_ticks = 32;

}  // namespace aureole
