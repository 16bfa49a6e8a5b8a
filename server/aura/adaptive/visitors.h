// Who is told of which bodies, apart from those whose regions they reach.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "server/aura/adaptive/outlook/outlook.h"
#include "server/aura/audience.h"
#include "server/aura/migration_policy.h"

namespace aureole {

/// A server that has an aura near a body visits it, and is told of it: of two that may meet each
/// hears of the other side. So is whoever hosts something on the way of what moves here, and
/// whoever is handed something that the body is near to.
class Visitors {
 public:
  void set_tolerances(const AuraTolerances& tolerances) {
    reach_s_ = reach_time_s(tolerances);
    clearance_m_ = visitor_clearance_m(tolerances);
    hold_ticks_ = verdict_hold_ticks(tolerances);
  }

  /// Begins a decision; both must outlive it.
  void begin(const MigrationSituation& situation, Outlook& outlook);

  /// Replaces `found` by all bodies that the aura is near to: its host visits them, and so does
  /// the region that it lies in. It may go home there without a word from us, and must find what it
  /// leans on.
  void find(const RemoteAura& aura, std::vector<std::uint32_t>& found);
  /// Warns those who host something on the way of what moves here: it must not come home into the
  /// way.
  void warn();
  /// Bodies go to another server together: until that one tells of their auras, it is told of what
  /// they are near to. What lies on a body that stays would fall through it there.
  void note_leaving(std::span<const std::uint32_t> bodies, RegionId to);
  /// When all leave who do: whoever was near to something lately counts. What is handed from one
  /// server to another is heard of by a third neither from the one nor from the other for some
  /// ticks: it is still there.
  void remember();

  /// Of a body, lately. Whoever comes on the stage after remember() has none.
  RegionSet of(std::uint32_t body) const { return body < near_.size() ? near_[body] : RegionSet{}; }

 private:
  void make_room();
  void look_ahead();
  void bring_in_visited();

  double reach_s_ = 0, clearance_m_ = 0;
  std::int64_t hold_ticks_ = 0;
  const MigrationSituation* situation_ = nullptr;
  Outlook* outlook_ = nullptr;
  std::vector<RegionSet> near_;  ///< By number on the stage.
  /// Who hosts something on the way of each body, by the last look ahead; ascending.
  std::vector<std::pair<BodyId, RegionSet>> warned_;
  Tick last_warning_{-1'000'000};
  /// Who has lately had auras near a body, each by itself; those of lower bodies first.
  struct Visit {
    BodyId visited;
    RegionId visitor;
    Tick at;
  };
  std::vector<Visit> visits_;
  std::vector<Visit> visits_before_;  ///< Only used within remember(); kept for its memory.
  std::vector<std::uint32_t> found_;  ///< The same for all that finds.
};

}  // namespace aureole
