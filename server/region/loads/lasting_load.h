// What a server has had to do for some time, as against what wakes for a moment.
#pragma once

#include <cstdint>
#include <optional>

#include "server/base/tick.h"
#include "server/region/loads/load_levels.h"

namespace aureole {

/// The mean of the last 20 s, in bodies awake; nothing at once where a server has calmed down, and
/// for 10 s whatever wakes there. A heap that goes home when lines come back wakes for a moment;
/// they would move for it, come back, and so for ever.
class LastingLoad {
 public:
  /// At every status: how many bodies are awake.
  void note_awake(double awake);
  /// What is to be told now. `lately`: the mean of the last second. `levels`: which loads count.
  double tell(Tick now, double lately, const LoadLevels& levels);
  /// The same again.
  double told() const { return told_; }

 private:
  double awake_ = 0;  ///< Smoothed.
  std::int64_t looks_ = 0;
  double told_ = 0;
  bool counted_ = false;      ///< There has been a load that counts.
  std::optional<Tick> calm_;  ///< When there was last none after that.
};

}  // namespace aureole
