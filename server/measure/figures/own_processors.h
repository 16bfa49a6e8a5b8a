// What is measured has a processor to itself.
#pragma once

#include <sched.h>
#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace aureole {

/// While it lives this thread keeps to one processor, and processes that it has started to one each
/// of the others. A process that wakes a few times a second on the processor of one that is
/// measured makes frames of 8 ms there out of those of one (docs/experiment-notes.md), and the
/// kernel puts it there as often as not.
class OwnProcessors {
 public:
  /// Of those that this thread may use. Where there are not more of them than `processes` nothing
  /// is done: then all share.
  explicit OwnProcessors(std::size_t processes);
  ~OwnProcessors();
  OwnProcessors(const OwnProcessors&) = delete;
  OwnProcessors& operator=(const OwnProcessors&) = delete;

  /// For a process that has just been started: a processor that nobody else has; none: nothing is
  /// done, or the process has ended.
  std::optional<int> take(pid_t process);
  /// It has ended.
  void give_back(std::optional<int> processor);

 private:
  cpu_set_t all_;
  std::vector<int> free_;
};

}  // namespace aureole
