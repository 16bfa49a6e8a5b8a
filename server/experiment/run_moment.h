// Where a run is, in memory that outlives the process that runs it: what is known of a seed that
// ended early.
#pragma once

#include <cstdint>
#include <string>

namespace aureole {

/// Which server was at which tick, and how many bodies it hosted before that.
struct RunMoment {
  std::int64_t tick = -1;  ///< -1: nothing has begun.
  std::int32_t server = -1;
  std::uint64_t bodies = 0;
};

/// From now on this process writes its moments there; null: nobody wants to know.
void share_run_moments(RunMoment* shared);
void note_run_moment(const RunMoment& moment);

/// "at tick 312, when r2 hosted 140 bodies and took its step"; empty if nothing has begun.
std::string describe(const RunMoment& moment);

}  // namespace aureole
