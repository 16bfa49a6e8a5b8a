// A real child: its lines, its end, and that it can be stopped.
#include <poll.h>
#include <unistd.h>

#include <csignal>

#include "server/play/child_process.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

ChildProcess shell(const std::string& script) {
  auto child = ChildProcess::start("/bin/sh", {"-c", script});
  REQUIRE(child);
  return std::move(*child);
}

/// Everything that the child writes until its output ends.
std::vector<std::string> all_lines(ChildProcess& child, Output which) {
  std::vector<std::string> lines;
  while (child.descriptor(which) >= 0) {
    pollfd ready{child.descriptor(which), POLLIN, 0};
    poll(&ready, 1, -1);
    child.read(which, [&](const std::string& line) { lines.push_back(line); });
  }
  return lines;
}

void wait_for_end(ChildProcess& child) {
  while (child.is_running()) usleep(1000);
}

}  // namespace

TEST_CASE("a child's output and errors come apart, line by line") {
  auto child = shell("echo out; echo err >&2; printf 'no end'");
  REQUIRE(all_lines(child, Output::standard) == std::vector<std::string>{"out", "no end"});
  REQUIRE(all_lines(child, Output::error) == std::vector<std::string>{"err"});
}

TEST_CASE("how a child ended is told as a person would say it") {
  auto failed = shell("exit 3");
  wait_for_end(failed);
  REQUIRE(failed.how_it_ended() == "exit code 3");
  auto killed = shell("kill -9 $$");
  wait_for_end(killed);
  REQUIRE(killed.how_it_ended() == "killed by signal 9");
}

TEST_CASE("a child that cannot be started says why on its error output") {
  auto child = ChildProcess::start("/nonexistent/aureole", {});
  REQUIRE(child);
  const auto lines = all_lines(*child, Output::error);
  REQUIRE(lines.size() == 1);
  REQUIRE(lines[0] == "/nonexistent/aureole cannot be started: No such file or directory");
  wait_for_end(*child);
  REQUIRE(child->how_it_ended() == "exit code 127");
}

TEST_CASE("a signal reaches what the child has started too") {
  auto child = shell("sleep 100 & echo $!; wait");
  std::vector<std::string> lines;
  while (lines.empty()) {
    child.read(Output::standard, [&](const std::string& line) { lines.push_back(line); });
  }
  const auto grandchild = static_cast<pid_t>(std::stol(lines[0]));
  REQUIRE(getpgid(grandchild) == child.pid());
  child.signal(SIGKILL);
  wait_for_end(child);
  REQUIRE(child.how_it_ended() == "killed by signal 9");
  // The pipe ends only when the last process that could write to it is gone.
  all_lines(child, Output::standard);
}

TEST_CASE("a child that goes out of scope is gone, even if it ignores requests to stop") {
  pid_t pid = 0;
  {
    auto child = shell("trap '' TERM; echo ready; while :; do sleep 1; done");
    pid = child.pid();
    REQUIRE(kill(pid, 0) == 0);
  }
  REQUIRE(kill(pid, 0) == -1);
  REQUIRE(errno == ESRCH);
}
