// What a server has had to do for some time, as against what wakes for a moment.
#pragma once

#include <cstdint>
#include <optional>

#include "server/base/tick.h"
#include "server/region/loads/load_levels.h"

namespace aureole {

/// How hard a server pushes at the lines of its region: what the servers have to do on the mean
/// (bodies awake, smoothed over 20 s), and the more above that the longer this one has had more
/// than the others. So lines go on moving until all have as much, where a load told as it is would
/// let them rest at a difference just large enough to hold them (an integral controller).
///
/// Nothing at once where a server has calmed down, and for 10 s whatever wakes there. A heap that
/// goes home when lines come back wakes for a moment; they would move for it, come back, and so for
/// ever.
class LastingLoad {
 public:
  /// At every status. `lately`: our load of the last second, in bodies awake, each counted as what
  /// it takes of a frame; `mean`: the same of all servers whose load counts, or 0 where none does.
  void note_awake(double lately, double mean);
  /// What is to be told now. `lately`: bodies awake, the mean of the last second. `levels`: which
  /// loads count.
  double tell(Tick now, double lately, const LoadLevels& levels);
  /// The same again.
  double told() const { return told_; }

 private:
  double own_ = 0, mean_ = 0;  ///< Smoothed.
  double excess_ = 0;  ///< Of our load over the mean (natural logarithm), summed up over 30 s.
  std::int64_t looks_ = 0;
  double told_ = 0;
  bool counted_ = false;      ///< There has been a load that counts.
  std::optional<Tick> calm_;  ///< When there was last none after that.
};

}  // namespace aureole
