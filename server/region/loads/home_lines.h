// Where regions end at present, as all servers know it at the same tick.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/aura/migration_mode.h"
#include "server/aura/partition/partition_lines.h"
#include "server/aura/partition/partition_map.h"
#include "server/base/tick.h"
#include "server/region/loads/load_levels.h"

namespace aureole {

/// The lines between regions follow the loads of the last quarter of a minute, so that who has more
/// to do has less ground. Bodies are born, players come and recovery takes place by the world's own
/// map; where a body is at home, and who decides about what meets, goes by the lines in force.
///
/// Loads travel as levels (load_levels.h), here 0.25 % apart. The lines of a term are the mean of
/// those that the levels of the last four terms ask for, so that no more is given away at once than
/// a quarter of the way. They depend on levels and on nothing else: whoever has heard of all of
/// them has the same lines at the same tick. Who has not knows it, and keeps a margin (margin_m()):
/// of two servers that disagree at least one tells the other of everything that either may have at
/// its own home.
class HomeLines {
 public:
  /// `self`: of whose load tell() tells; for who only hears, any. `moves`: false keeps them where
  /// the map has them, whatever is told.
  HomeLines(const PartitionMap& map, RegionId self, bool moves);
  /// Whether they move in such a world: two that meet nowhere else shift the line between them for
  /// what they contest (load_balance.h).
  static bool move_in(MigrationMode mode, const PartitionMap& map) {
    return mode == MigrationMode::adaptive && map.has_corners();
  }

  /// Loads below this are all alike (bodies awake, > 0); see LoadLevels::awake_min.
  void level_from(double awake) { levels_.level_from(awake); }

  /// At every status of ours: how many bodies are awake here.
  void note_awake(std::size_t awake);
  /// What our next status says. `lately`: the mean of the last second, in bodies awake: who has
  /// calmed down has no load at once, and for some seconds, whatever wakes.
  LoadLevels::Told tell(Tick now, double lately);
  void hear(RegionId from, Tick told_at, LoadLevels::Told told);

  /// Moves the lines to where they are at this tick; whether the map, or the margin, is another one
  /// than before.
  bool move(Tick now);
  const PartitionMap& map() const { return map_; }
  /// How far others' lines may be from ours, as of the last move() (m): 0, unless we have not heard
  /// of a level that the lines in force depend on.
  double margin_m() const { return margin_m_; }
  /// Whether lines are where the world has them, and stay there unless somebody gets more to do:
  /// nothing that is known here moves them.
  bool settled() const;

 private:
  /// What the levels of a term ask for.
  struct Wanted {
    std::vector<double> shifts_m;
    bool sure = false;  ///< All levels have been heard.
  };
  static constexpr std::size_t terms_in_mind = 4;
  void begin_term(std::int64_t term);
  bool look_up(Tick as_of);

  PartitionMap map_;
  RegionId self_;
  PartitionLines lines_;
  LoadLevels levels_;
  bool moves_;
  double margin_m_ = 0;
  double awake_ = 0;          ///< Smoothed.
  double told_ = 0;           ///< The load that our last status was about.
  bool counted_ = false;      ///< There has been a load that counts.
  std::optional<Tick> calm_;  ///< When there was last none after that.
  std::int64_t looks_ = 0;
  std::int64_t term_ = -1;                    ///< As of the last move().
  std::array<Wanted, terms_in_mind> wanted_;  ///< Of that term first, then of those before.
  std::vector<std::uint16_t> levels_now_;     ///< What the first of them is for.
};

}  // namespace aureole
