// Which region a body belongs to: its place decides, and who has more to do.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/aura/adaptive/load_balance.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// Where regions end as far as homes are concerned. Everything belongs to the region that it lies
/// in, but for a strip along the boundary of one that has more to do than its neighbour
/// (line_shift_m()):
///
///   - What the neighbour hosts there stays with it.
///   - What stirs there, and is hosted by the region itself, belongs to the neighbour if that has
///     had less to do for seconds; half as far in, so that what is given does not come back at the
///     next whim. What rests costs nothing where it lies, and where a third region is near nothing
///     is given: it might have to go on to that one. Nor is anything in a world without corners,
///     where servers differ less than what is given away costs (docs/performance.md).
class HomeLines {
 public:
  /// Once for every time that somebody may go home. The situation must outlive the questions.
  void look(const MigrationSituation& situation);

  /// The region that a body hosted here belongs to: ours, if it stays.
  RegionId home_of(const WorldPosition& at, bool rests) const;

 private:
  RegionId given_to(const WorldPosition& at) const;

  const MigrationSituation* situation_ = nullptr;
  /// How far the line between ours and each region is shifted into ours (m), now …
  std::vector<double> shifts_m_;
  /// … and over the last seconds.
  std::vector<double> lasting_shifts_m_;
  std::optional<std::uint64_t> map_version_;
  bool has_corners_ = false;  ///< That map; without any no shift lasts.
  bool gives_ = false;        ///< Whether any line lies so that something may belong to others.
};

}  // namespace aureole
