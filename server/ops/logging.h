// One line for each event on stderr, with the time, the role of this process and the level.
#pragma once

#include <string>

#include "server/base/result.h"

namespace aureole {

/// The level that --log-level or, without it, the environment variable AUREOLE_LOG_LEVEL names.
/// Both empty: `otherwise`.
std::string chosen_log_level(const std::string& option, const char* otherwise = "info");

/// Makes spdlog's default logger write `12:34:56.789 r0 info: text` to stderr. `role` is one word:
/// r0, gateway, play. Errors: an unknown level (trace, debug, info, warning, error, off exist).
/// To log, include <spdlog/spdlog.h> and call spdlog::info and its sisters.
Status start_logging(const std::string& role, const std::string& level);

/// A line of a child process as its parent shows it: as it is if it carries the child's role where
/// start_logging puts it, otherwise with `role: ` in front.
std::string line_with_role(const std::string& role, const std::string& line);

}  // namespace aureole
