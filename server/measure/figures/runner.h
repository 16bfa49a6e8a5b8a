// Makes the runs of a plan one after the other, each as a process of its own, and goes on where an
// earlier start was interrupted.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/measure/figures/plan.h"

namespace aureole {

struct RunnerOptions {
  std::filesystem::path executable;  ///< `aureole`.
  std::string build;                 ///< Its build_version().
  std::filesystem::path out;         ///< Runs go to `runs` in it.
  int jobs = 1;                      ///< Processes at a time; more than one disturb each other.
  bool any_build = false;            ///< What another build has made counts as made.
  int stop_fd = -1;                  ///< Stops when there is something to read from it.
};

struct RunnerReport {
  std::function<void(const std::string&)> say;   ///< A line that stays.
  std::function<void(const std::string&)> show;  ///< What is running now; replaces the last one.
};

struct RunnerOutcome {
  std::size_t already = 0;  ///< Made earlier with the same command line by the same build.
  std::size_t made = 0;
  std::size_t failed = 0;
  bool stopped = false;  ///< By `stop_fd`; what ran then has left nothing.
};

/// A run that fails is told with its command and its last lines, and the others go on. Errors: the
/// folder cannot be made or written.
Result<RunnerOutcome> run_plan(const std::vector<PlannedRun>& plan, const RunnerOptions& options,
                               const RunnerReport& report);

/// As one would type it.
std::string command_line(const std::vector<std::string>& arguments);

/// "25 s", "4 min", "2 h 05 min".
std::string in_words(double seconds);

}  // namespace aureole
