// Log lines as a person sees them: with time, role and level, from children too.
#include <cstdlib>

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <regex>

#include "server/ops/logging.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// What `body` writes to stderr.
template <class Body>
std::string stderr_of(Body body) {
  std::fflush(stderr);
  std::FILE* file = std::tmpfile();
  const int old = dup(STDERR_FILENO);
  dup2(fileno(file), STDERR_FILENO);
  body();
  std::fflush(stderr);
  dup2(old, STDERR_FILENO);
  close(old);
  std::rewind(file);
  std::string out;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) out += static_cast<char>(c);
  std::fclose(file);
  return out;
}

}  // namespace

TEST_CASE("a log line says when, who and how bad; what is below the level is left out") {
  const std::string lines = stderr_of([] {
    REQUIRE(start_logging("r0", "info"));
    spdlog::debug("not this");
    spdlog::info("two neighbours are linked");
  });
  REQUIRE(std::regex_match(
      lines, std::regex(R"(\d\d:\d\d:\d\d\.\d{3} r0 info: two neighbours are linked\n)")));
}

TEST_CASE("an unknown log level is refused with the ones there are") {
  const Status wrong = start_logging("r0", "loud");
  REQUIRE_FALSE(wrong);
  REQUIRE(wrong.error().message.find("'loud'; expected trace, debug") != std::string::npos);
}

TEST_CASE("the option goes before the environment, which goes before the default") {
  unsetenv("AUREOLE_LOG_LEVEL");
  REQUIRE(chosen_log_level("") == "info");
  REQUIRE(chosen_log_level("", "warning") == "warning");
  setenv("AUREOLE_LOG_LEVEL", "debug", 1);
  REQUIRE(chosen_log_level("", "warning") == "debug");
  REQUIRE(chosen_log_level("error") == "error");
  unsetenv("AUREOLE_LOG_LEVEL");
}

TEST_CASE("a parent names the child in front of lines that do not name it themselves") {
  REQUIRE(line_with_role("r1", "12:00:00.000 r1 info: up") == "12:00:00.000 r1 info: up");
  REQUIRE(line_with_role("r1", "12:00:00.000 r10 info: up") == "r1: 12:00:00.000 r10 info: up");
  REQUIRE(line_with_role("r1", "terminate called") == "r1: terminate called");
  REQUIRE(line_with_role("r1", "") == "r1: ");
}
