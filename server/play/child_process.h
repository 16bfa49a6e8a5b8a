// One child process with its output as lines; it never outlives this process.
#pragma once

#include <sys/types.h>

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/play/line_splitter.h"

namespace aureole {

enum class Output { standard, error };

/// Starts in a process group of its own, so that a Ctrl-C in the terminal reaches only the parent,
/// which then stops its children in order. The kernel kills it when the parent's thread that
/// started it ends, however that ends.
class ChildProcess {
 public:
  static Result<ChildProcess> start(const std::filesystem::path& executable,
                                    const std::vector<std::string>& arguments);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  /// Kills the process if it still runs.
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  /// To wait on with poll(); -1 once that output has ended.
  int descriptor(Output which) const { return pipes_[static_cast<std::size_t>(which)].fd; }

  /// Reads what is there without waiting.
  void read(Output which, const std::function<void(const std::string&)>& line);

  /// Whether it still runs; takes note of its end. Never waits.
  bool is_running();
  /// "exit code 1" or "killed by signal 9"; only after is_running() was false.
  std::string how_it_ended() const;

  /// Sends a signal to it and to everything that it may have started.
  void signal(int number) const;

 private:
  ChildProcess() = default;

  struct Pipe {
    int fd = -1;
    LineSplitter lines;
  };
  pid_t pid_ = -1;
  std::optional<int> wait_status_;
  std::array<Pipe, 2> pipes_;
};

}  // namespace aureole
