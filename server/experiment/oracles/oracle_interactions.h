// Rule 3: bodies on different servers that overlap, or that went through each other between ticks.
#pragma once

#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "server/aura/shapes/box_rows.h"
#include "server/experiment/oracles/oracle_ownership.h"
#include "server/experiment/oracles/tolerance_record.h"
#include "server/experiment/oracles/view/body_shapes.h"
#include "server/experiment/oracles/view/world_view.h"
#include "server/region/stand_ins/stand_in_watch.h"

namespace aureole {

/// Looks at every pair of near bodies with different owners, all at the same tick of world time. A
/// pair counts once until it has separated. It counts as in tolerance at the first tick at which
/// nothing excuses it: neither server, nor the link between them, nor an earlier owner of either
/// body, was outside of its tolerances in the last T_T + 1 s, and neither body was faster than V_t.
///
/// What is left out, because one server would not have done better:
///  - Overlaps that the pair brought along when it was cut: Bullet lets heaps sink into each other
///    by centimetres. Only what grows by more than the slop after the cut counts.
///  - Passing between two ticks where Bullet, given both bodies, would not have seen them touch
///    either (fast small bodies tunnel on one server too): each case is tried out.
///  - An overlap that begins, or a stand-in that is struck, so soon after the birth of one of the
///    two (T_T, in mode adaptive its reach time), by an injector or as a player's avatar, that
///    nobody can have heard of it. Counted apart, as `missed_at_birth`.
class InteractionOracle {
 public:
  InteractionOracle(const WorldDefinition& world, const ToleranceRecord& tolerances,
                    const OwnershipOracle& ownership);

  /// Once for each tick, ascending, with all bodies at that tick.
  void look(Tick tick, const std::vector<SeenBody>& bodies);
  /// Seen by a region's own watch.
  void stand_in_struck(RegionId region, const StandInWatch::Struck& struck);

  void report(SeedResult& result) const;
  std::uint64_t missed() const { return missed_; }
  std::uint64_t missed_in_tolerance() const { return missed_in_tolerance_; }

  /// Contact slop (m): what two bodies may overlap by and still count as touching.
  static constexpr double slop_m = 0.03;

 private:
  struct Track {
    SeenBody last;
    Tick seen;
    Tick outside = ToleranceRecord::long_ago;  ///< Of itself or of what it was hosted by.
  };
  using Pair = std::pair<BodyId, BodyId>;
  struct Overlap {
    Tick seen;
    double brought_m = 0;  ///< How deep it was when the two were cut.
    bool at_birth = false, counted = false, counted_in_tolerance = false;
  };
  void follow(Tick tick, const std::vector<SeenBody>& bodies);
  void look_at_pair(Tick tick, const SeenBody& a, const SeenBody& b);
  Overlap& begin_overlap(Tick tick, const SeenBody& a, const SeenBody& b, double depth_m);
  void count(Tick tick, const SeenBody& a, const SeenBody& b, Overlap& overlap, double depth_m,
             const char* how);
  bool passed_through(Tick tick, const SeenBody& a, const SeenBody& b) const;
  bool was_apart(Tick tick, const SeenBody& a, const SeenBody& b) const;
  bool is_excused(Tick tick, const SeenBody& a, const SeenBody& b) const;
  bool is_newborn(BodyId id, Tick tick) const;

  const WorldDefinition& world_;
  const ToleranceRecord& tolerances_;
  const OwnershipOracle& ownership_;
  BodyShapes shapes_;
  BoxRows rows_;
  std::vector<AuraBox> boxes_;
  std::unordered_map<BodyId, Track> tracks_;  ///< As of the tick before.
  std::map<Pair, Overlap> overlaps_;
  std::uint64_t missed_ = 0, missed_in_tolerance_ = 0, at_birth_ = 0, struck_ = 0;
  std::vector<Violation> violations_;
};

}  // namespace aureole
