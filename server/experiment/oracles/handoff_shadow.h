// How far a handoff moves bodies: each is compared with a shadow of the sender's world that was
// stepped on without the handoff.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "server/experiment/oracles/oracle_ownership.h"
#include "server/experiment/oracles/view/world_view.h"
#include "server/worlds/world.h"

namespace aureole {

/// Bullet's world cannot be cloned bit for bit. The shadow is a scratch world with the group as it
/// was sealed (states and contacts with their impulses, taken after the sender's last step with
/// it), and what the sender keeps within a few metres, with its contacts. It is stepped to the tick
/// of the receiver's first step with the group, and there the positions are compared.
///
/// Left out, because the difference would not be the handoff's: groups with avatars (players
/// steer), groups that sleep (they are where they were), moments around blasts and throws, groups
/// that meet something of the receiver's by then (that is what they were brought together for). Not
/// every handoff is followed: `sampled_max`.
class HandoffShadow {
 public:
  /// How far one body was moved by one handoff.
  struct Jump {
    BodyId body;
    RegionId from, to;
    Tick tick;  ///< Of the receiver's first step with it.
    double mm = 0;
  };
  static constexpr double neighbourhood_m = 2.5;
  static constexpr std::size_t group_max = 120;
  static constexpr std::size_t sampled_max = 400;
  /// A longer flight is outside of the tolerances of any world.
  static constexpr std::int64_t flight_ticks_max = 8;

  explicit HandoffShadow(const WorldDefinition& world);

  /// What has just left, from a server that has just stepped.
  void left(const RegionCore& sender, Tick tick, std::span<const Departure> departures,
            bool players_act);
  /// A server has just stepped: whatever it has now that is being followed is compared.
  void stepped(RegionId receiver, Tick tick, const RegionCore& core, bool players_act);

  /// Follows up to sampled_max handoffs more from now on.
  void sample_anew() { sampled_ = 0; }

  void report(SeedResult& result) const;
  const std::vector<Jump>& jumps() const { return jumps_; }
  const std::vector<double>& jumps_mm() const { return jumps_mm_; }
  /// That of 99 % of all, the rest is larger (mm); null if nothing was followed.
  const Jump* p99() const;

 private:
  struct Followed {
    Tick tick;  ///< Of the states.
    RegionId from, to;
    std::vector<NewBody> group, near;
    std::vector<ContactManifold> contacts;
  };
  void compare(const Followed& followed, Tick tick, const RegionCore& receiver);
  bool meets_others(const PhysicsWorld& shadow, const Followed& followed,
                    const RegionCore& receiver) const;

  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> statics_;
  std::unique_ptr<PhysicsWorld> physics_;  ///< Only its shapes are used.
  std::deque<Followed> followed_;
  std::size_t sampled_ = 0;
  std::vector<Jump> jumps_;
  std::vector<double> jumps_mm_;  ///< The same, lengths only.
};

}  // namespace aureole
