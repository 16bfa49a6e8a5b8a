// A process under test: its lines are kept, and it is gone when the test ends, however that ends.
#pragma once

#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "server/play/child_process.h"
#include "tests/support/catch.h"

namespace aureole::test {

class Running {
 public:
  Running(const std::string& executable, const std::vector<std::string>& arguments)
      : process_(start(executable, arguments)) {}

  /// Reads on until a line on either output contains `text`; fails the test if the process ends or
  /// `limit_s` is over before that. Lines that came earlier count too.
  std::string wait_for_line(const std::string& text, int limit_s = 30) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(limit_s);
    while (true) {
      if (const auto found = line_with(text)) return *found;
      const bool ended = !process_.is_running();
      read(20);
      if (const auto found = line_with(text)) return *found;
      if (ended || std::chrono::steady_clock::now() > end) {
        FAIL((ended ? "ended without: " : "no line in time: ") << text << "\n" << all());
      }
    }
  }

  /// Waits until it has ended; "exit code 0" and so on. Fails the test if that takes too long.
  std::string wait_for_end(int limit_s = 30) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(limit_s);
    while (process_.is_running()) {
      read(20);
      if (std::chrono::steady_clock::now() > end) FAIL("still running\n" << all());
    }
    read(0);
    return process_.how_it_ended();
  }

  void signal(int number) { process_.signal(number); }
  pid_t pid() const { return process_.pid(); }

  std::optional<std::string> line_with(const std::string& text) const {
    for (const auto* lines : {&out, &err}) {
      for (const auto& line : *lines) {
        if (line.find(text) != std::string::npos) return line;
      }
    }
    return std::nullopt;
  }
  /// Everything it has said, for messages of failed tests.
  std::string all() const {
    std::string text;
    for (const auto& line : out) text += "out: " + line + "\n";
    for (const auto& line : err) text += "err: " + line + "\n";
    return text;
  }

  std::vector<std::string> out, err;  ///< Lines so far.

 private:
  static ChildProcess start(const std::string& executable,
                            const std::vector<std::string>& arguments) {
    auto child = ChildProcess::start(executable, arguments);
    if (!child) FAIL(child.error().message);
    return std::move(*child);
  }

  void read(int wait_ms) {
    pollfd outputs[] = {{process_.descriptor(Output::standard), POLLIN, 0},
                        {process_.descriptor(Output::error), POLLIN, 0}};
    poll(outputs, 2, wait_ms);
    process_.read(Output::standard, [&](const std::string& line) { out.push_back(line); });
    process_.read(Output::error, [&](const std::string& line) { err.push_back(line); });
  }

  ChildProcess process_;
};

/// Whether the process is gone, within a patient while. A zombie counts as gone: its parent has
/// ended, and whoever inherits it may be slow to take note.
inline bool is_gone(pid_t pid, int limit_s = 10) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(limit_s);
  while (std::chrono::steady_clock::now() < end) {
    if (kill(pid, 0) != 0) return true;
    const std::string path = "/proc/" + std::to_string(pid) + "/stat";
    if (std::FILE* file = std::fopen(path.c_str(), "r")) {
      char state = '?';
      const int read = std::fscanf(file, "%*d (%*[^)]) %c", &state);
      std::fclose(file);
      if (read == 1 && (state == 'Z' || state == 'X')) return true;
    }
    usleep(10'000);
  }
  return false;
}

}  // namespace aureole::test
