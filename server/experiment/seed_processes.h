// Work in child processes, as many at a time as there are cores: Bullet is not thread-safe, and a
// child that dies is a result like any other.
#pragma once

#include <functional>
#include <string>

#include "server/experiment/run_moment.h"

namespace aureole {

struct ChildOutcome {
  bool ended_well = false;
  std::string output;  ///< What the work returned; empty unless it ended well.
  std::string how;     ///< Else: in which way it ended, with the last that it said on stderr.
  RunMoment moment;    ///< Else: where its simulation was then.
};

struct ChildOptions {
  int count = 1;         ///< Pieces of work.
  int jobs = 1;          ///< At a time.
  double limit_s = 600;  ///< A child that takes longer is killed.
};

/// Calls `work(i)` for 0 … count - 1, each in a forked process, and `done(i, outcome)` here in the
/// order in which they end. `idle` is called about four times a second. The calling process should
/// not have used Bullet before.
void run_in_processes(
    const ChildOptions& options, const std::function<std::string(int)>& work,
    const std::function<void(int, const ChildOutcome&)>& done,
    const std::function<void()>& idle = [] {});

}  // namespace aureole
