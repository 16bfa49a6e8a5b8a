// What verdicts have given away or asked for, until it has arrived.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/migration_policy.h"
#include "server/aura/shapes/box_rows.h"

namespace aureole {

/// Where an arbiter has lately given bodies, ours and others': whoever meets them goes there too,
/// and what comes here is not met halfway.
class Promises {
 public:
  struct Promise {
    RegionId to;
    Tick at;              ///< For the last time.
    Tick since;           ///< To the same server.
    Company::Hold known;  ///< Of either side by then: what is asked for all the same comes.
  };

  void set_tolerances(const AuraTolerances& tolerances) {
    reach_s_ = reach_time_s(tolerances);
    hold_ticks_ = verdict_hold_ticks(tolerances);
  }

  /// Begins a decision, which the situation must outlive: forgets what is too old.
  void begin(const MigrationSituation& situation);
  /// By a verdict of this decision. For one that is given to the same server again the time runs
  /// on, but for one that was left out between, and where more is known now of how it is held.
  /// Returns the most that is or was known.
  Company::Hold give(BodyId body, RegionId to, Company::Hold known);

  /// Null if it has not been given lately.
  const Promise* of(BodyId body) const;
  /// Before may_come(), by what others tell of now.
  void note_coming();
  /// Whether it comes here, or may have become part by now of a cluster that does.
  bool may_come(const RemoteAura& aura) const;

 private:
  bool is_coming(const RemoteAura& aura) const;

  double reach_s_ = 0;
  std::int64_t hold_ticks_ = 0;
  const MigrationSituation* situation_ = nullptr;
  std::map<BodyId, Promise> promises_;
  using TheirCluster = std::pair<RegionId, std::uint16_t>;  ///< Its host and label.
  /// Who hosts each of the auras of clusters that have been asked for, and boxes around these.
  std::vector<RegionId> coming_;
  BoxRows coming_rows_;
};

}  // namespace aureole
