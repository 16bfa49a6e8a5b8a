// Where regions end at present, as all servers know it at the same tick.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/aura/migration_mode.h"
#include "server/aura/partition/partition_lines.h"
#include "server/aura/partition/partition_map.h"
#include "server/base/tick.h"
#include "server/region/lines/line_keeper.h"
#include "server/region/lines/line_news.h"
#include "server/region/loads/lasting_load.h"
#include "server/region/loads/load_levels.h"

namespace aureole {

/// Bodies are born, players come and recovery takes place by the world's own map; where a body is
/// at home, and who decides about what meets, goes by the lines in force.
///
/// Around corners lines give way to who has had more to do (lasting_load.h), until all have as much
/// (PartitionLines::shifts_m()). In a row of regions each goes to where little happens, or to where
/// a large crowd is shared out evenly, as its keeper says (line_keeper.h).
///
/// What they depend on travels as levels (load_levels.h): how hard each server pushes, 0.25 %
/// apart, or the places of lines. The lines of a term are the mean of those that the levels of the
/// last four terms ask for, so that no more is given away at once than a quarter of the way. They
/// depend on levels and on nothing else: whoever has heard of all of them has the same lines at the
/// same tick. Who has not knows it, and keeps a margin (margin_m()): of two servers that disagree
/// at least one tells the other of everything that either may have at its own home.
class HomeLines {
 public:
  enum class Rule : std::uint8_t {
    still,         ///< They stay where the map has them, whatever is told.
    even_loads,    ///< Who has more to do has less ground.
    quiet_places,  ///< They go where little happens, or where a crowd is shared out evenly.
  };
  static Rule rule_in(MigrationMode mode, const PartitionMap& map) {
    if (mode != MigrationMode::adaptive) return Rule::still;
    return map.has_corners() ? Rule::even_loads : Rule::quiet_places;
  }

  /// `self`: of whose load tell() tells; for who only hears, any.
  HomeLines(const PartitionMap& map, RegionId self, Rule rule);
  Rule rule() const { return rule_; }

  /// Loads below this are all alike (bodies awake, > 0); see LoadLevels::awake_min and LineKeeper.
  /// `limits`: of the crowds that a line of a row may leave.
  void level_from(double awake, const QuietPlaceLimits& limits = {}) {
    levels_.level_from(awake);
    keeper_.look_from(awake, limits);
  }

  /// At every status of ours: who is awake here; and how many are anywhere, by region, the mean of
  /// the last second.
  void note_awake(std::span<const NewBody> awake, std::span<const double> everywhere);
  /// What our next status says. `lately`: what we have awake, the mean of the last second.
  LineNews tell(Tick now, double lately);
  void hear(RegionId from, Tick told_at, const LineNews& told);

  /// Moves the lines to where they are at this tick; whether the map, or the margin, is another one
  /// than before.
  bool move(Tick now);
  const PartitionMap& map() const { return map_; }
  /// How far others' lines may be from ours, as of the last move() (m): 0, unless we have not heard
  /// of a level that the lines in force depend on.
  double margin_m() const { return margin_m_; }
  /// Whether lines stay where they are unless somebody gets more to do: nothing that is known here
  /// moves them. Around corners that is where the map has them, in a row wherever they are.
  bool settled() const;

 private:
  /// What the levels of a term ask for.
  struct Wanted {
    std::vector<double> shifts_m;
    bool sure = false;  ///< All levels have been heard that matter here.
  };
  static constexpr std::size_t terms_in_mind = 4;
  LoadLevels::Told tell_place(Tick now);
  LineNews tell_of_row(Tick now);
  double place_m(std::size_t line, std::uint16_t level) const;
  static std::uint16_t level_at(double place_m);
  double margin_m(bool sure) const;
  bool knows_near(Tick as_of) const;
  void begin_term(std::int64_t term);
  bool look_up(Tick as_of);

  PartitionMap map_;
  RegionId self_;
  PartitionLines lines_;
  LoadLevels levels_;
  Rule rule_;
  LineKeeper keeper_;
  std::vector<double> frame_of_body_;   ///< What one awake takes of it, by region; 1: its physics.
  std::vector<RegionId> keepers_near_;  ///< Of the lines of our region and of its neighbours.
  double awake_now_ = 0;                ///< Bodies.
  std::optional<Tick> first_told_;
  double margin_m_ = 0;
  LastingLoad load_;
  std::int64_t term_ = -1;                    ///< As of the last move().
  std::array<Wanted, terms_in_mind> wanted_;  ///< Of that term first, then of those before.
  std::vector<std::uint16_t> levels_now_;     ///< What the first of them is for.
};

}  // namespace aureole
