// Starts a whole world as child processes, watches over them, and takes all of them down in the
// end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/play/command_lines.h"

namespace aureole {

struct SupervisorOptions {
  std::filesystem::path executable;
  std::string page_url;                  ///< Printed once the world is ready.
  std::string health_url;                ///< Answers 200 when the world is ready.
  std::int64_t start_limit_ms = 60'000;  ///< For all to be ready.
  std::int64_t stop_limit_ms = 1'000;    ///< From SIGTERM to SIGKILL.
  std::size_t restarts_per_minute = 5;   ///< Of each process.
};

enum class PlayEnd {
  asked,            ///< SIGINT, SIGTERM or SIGHUP came; nothing went wrong.
  failed_at_start,  ///< A process ended, or not all were ready in time.
  failed_later,     ///< One of them ended too often.
};

struct PlayOutcome {
  PlayEnd end = PlayEnd::asked;
  std::string sentence;  ///< What went wrong; empty for `asked`.
};

/// Runs the processes until a signal asks it to stop or one of them ends too often. What ends while
/// the world runs is started again: players reconnect to the gateway, and a region goes on with its
/// bodies. Prints `Open URL` on stdout when the world is
/// ready; forwards every line of the children to stderr. When it returns, no child is left. Takes
/// SIGINT, SIGTERM, SIGHUP and SIGCHLD away from the rest of the process for good.
PlayOutcome run_world(const SupervisorOptions& options, const std::vector<ProcessPlan>& plan);

}  // namespace aureole
