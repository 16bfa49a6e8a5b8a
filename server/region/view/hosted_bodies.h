// What a policy is shown of the bodies that are hosted here.
#pragma once

#include <span>
#include <vector>

#include "server/aura/migration_policy.h"
#include "server/aura/sleepers.h"
#include "server/base/ids.h"
#include "server/base/tick.h"
#include "server/region/hosting.h"
#include "server/region/stand_ins/stand_in_watch.h"
#include "server/region/view/boundary_strip.h"
#include "server/region/view/nearby_geometry.h"

namespace aureole {

/// Those who are awake are looked at in every decision, if they are near enough to the boundary or
/// to others' auras; those who sleep once, when they fall asleep. A policy that has no use for that
/// (MigrationPolicy::depth_m() is infinite) is shown everybody.
class HostedBodies {
 public:
  HostedBodies(const PartitionMap& map, RegionId self, std::span<const StaticDefinition> statics)
      : nearby_geometry_(statics), strip_(map, self), sleepers_(map.area(self)) {}

  /// The region ends elsewhere now, or others may think so (`margin_m`: by how much).
  void move_home(const PartitionMap& map, RegionId self, double margin_m);

  /// Once a decision. `apart`: those who sleep are kept apart.
  void begin(Hosting& hosting, bool apart, Tick now);
  /// Before each look: how deep the strip is for it, and what others project. Infinite: whoever is
  /// awake is shown, wherever it is.
  void show_within(double depth_m, std::span<const RemoteAura> remote);

  struct Look {
    const StandInWatch& watch;
    double reach_s = 0;
    /// To be shown wherever they are; ascending, some may not be here.
    std::span<const BodyId> asked_for;
    /// To be shown though they sleep; the same.
    std::span<const BodyId> stirred;
  };
  /// Ascending; see MigrationSituation::hosted. The caller's until the next call.
  std::vector<HostedBody>& look(Hosting& hosting, const Look& look, Tick now);

  /// What look() shows; null: everything.
  const View* view() const { return shows_all_ ? nullptr : &strip_; }
  /// Null: they are among those that look() returns.
  const Sleepers* sleepers() const { return apart_ ? &sleepers_ : nullptr; }

 private:
  void keep_sleepers(Hosting& hosting, std::span<const BodyId> changed);
  void lay_down(Hosting& hosting, BodyId id);
  void glimpse(const Hosting& hosting, const BodyGlance& seen, HostedBody& body) const;
  void find_shown(Hosting& hosting, const Look& look);
  void show(Hosting& hosting, const BodyGlance& seen, const Look& look, Tick now);

  NearbyGeometry nearby_geometry_;
  BoundaryStrip strip_;
  Sleepers sleepers_;
  bool apart_ = false;
  bool shows_all_ = false;
  std::vector<BodyId> awake_;  ///< As of the last decision; ascending.
  std::vector<BodyId> awake_now_;
  static constexpr std::size_t sleeps = static_cast<std::size_t>(-1);
  struct Shown {
    BodyId id;
    std::size_t awake;  ///< Its place among those awake, or `sleeps`.
  };
  std::vector<Shown> shown_;  ///< Only used within look().
  std::vector<HostedBody> hosted_;
};

}  // namespace aureole
