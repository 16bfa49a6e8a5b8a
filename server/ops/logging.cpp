// Sets up spdlog once for each process; see logging.h.
#include "server/ops/logging.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace aureole {
namespace {

constexpr std::array<std::pair<std::string_view, spdlog::level::level_enum>, 6> levels{{
    {"trace", spdlog::level::trace},
    {"debug", spdlog::level::debug},
    {"info", spdlog::level::info},
    {"warning", spdlog::level::warn},
    {"error", spdlog::level::err},
    {"off", spdlog::level::off},
}};

}  // namespace

std::string chosen_log_level(const std::string& option, const char* otherwise) {
  if (!option.empty()) return option;
  const char* environment = std::getenv("AUREOLE_LOG_LEVEL");
  return environment != nullptr && *environment != '\0' ? environment : otherwise;
}

Status start_logging(const std::string& role, const std::string& level) {
  const auto* found =
      std::find_if(levels.begin(), levels.end(), [&](const auto& l) { return l.first == level; });
  if (found == levels.end()) {
    return Error::format(
        "the log level is '{}'; expected trace, debug, info, warning, error or off", level);
  }
  auto logger =
      std::make_shared<spdlog::logger>(role, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%H:%M:%S.%e %n %l: %v");
  logger->set_level(found->second);
  logger->flush_on(spdlog::level::trace);  // a killed process has still said why
  spdlog::set_default_logger(std::move(logger));
  return Ok{};
}

std::string line_with_role(const std::string& role, const std::string& line) {
  const auto time_ends = line.find(' ');
  if (time_ends != std::string::npos &&
      line.compare(time_ends + 1, role.size() + 1, role + " ") == 0) {
    return line;
  }
  return role + ": " + line;
}

}  // namespace aureole
