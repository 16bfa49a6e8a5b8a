// fork, two pipes for each child, poll.
#include "server/experiment/seed_processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

#include "server/base/check.h"

namespace aureole {
namespace {

using Clock = std::chrono::steady_clock;
/// Of what a child says on stderr the end is kept.
constexpr std::size_t complaint_max = 2000;

struct Child {
  int index = 0;
  pid_t pid = -1;
  int output = -1, complaint = -1;  ///< Reading ends; -1 once they are at their end.
  std::string said, complained;
  Clock::time_point started;
  bool too_long = false;
  RunMoment* moment = nullptr;  ///< Shared with the child.
};

void write_all(int to, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = ::write(to, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    written += static_cast<std::size_t>(n);
  }
}

Child start(int index, const std::function<std::string(int)>& work) {
  int output[2], complaint[2];
  AUREOLE_CHECK(::pipe2(output, O_CLOEXEC) == 0 && ::pipe2(complaint, O_CLOEXEC) == 0,
                "there are pipes for a child process");
  void* const shared =
      ::mmap(nullptr, sizeof(RunMoment), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  AUREOLE_CHECK(shared != MAP_FAILED, "there is memory to share with a child process");
  std::fflush(nullptr);
  Child child;
  child.moment = new (shared) RunMoment;
  child.index = index;
  child.started = Clock::now();
  child.pid = ::fork();
  AUREOLE_CHECK(child.pid >= 0, "a child process can be started");
  if (child.pid == 0) {
    ::dup2(complaint[1], STDERR_FILENO);
    // Whatever this process does about signals is not the child's matter.
    for (const int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGFPE, SIGILL})
      ::signal(signal, SIG_DFL);
    share_run_moments(child.moment);
    write_all(output[1], work(index));
    ::_exit(0);
  }
  ::close(output[1]);
  ::close(complaint[1]);
  child.output = output[0];
  child.complaint = complaint[0];
  return child;
}

/// Reads what there is; closes the pipe at its end.
void drain(int& from, std::string& into, std::size_t keep) {
  char buffer[65'536];
  const ssize_t n = ::read(from, buffer, sizeof buffer);
  if (n < 0 && errno == EINTR) return;
  if (n <= 0) {
    ::close(from);
    from = -1;
    return;
  }
  into.append(buffer, static_cast<std::size_t>(n));
  if (into.size() > keep) into.erase(0, into.size() - keep);
}

ChildOutcome finish(Child& child, double limit_s) {
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  ChildOutcome outcome;
  const RunMoment moment = *child.moment;
  ::munmap(child.moment, sizeof(RunMoment));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    outcome.ended_well = true;
    outcome.output = std::move(child.said);
    return outcome;
  }
  if (child.too_long)
    outcome.how = fmt::format("was not done after {:.0f} s", limit_s);
  else if (WIFSIGNALED(status))
    outcome.how =
        fmt::format("ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  else
    outcome.how = fmt::format("ended with exit code {}", WEXITSTATUS(status));
  outcome.moment = moment;
  if (moment.tick >= 0) outcome.how += " " + describe(moment);
  if (!child.complained.empty()) outcome.how += ": " + child.complained;
  while (!outcome.how.empty() && outcome.how.back() == '\n') outcome.how.pop_back();
  return outcome;
}

}  // namespace

void run_in_processes(const ChildOptions& options, const std::function<std::string(int)>& work,
                      const std::function<void(int, const ChildOutcome&)>& done,
                      const std::function<void()>& idle) {
  std::vector<Child> children;
  int next = 0;
  while (next < options.count || !children.empty()) {
    while (next < options.count && static_cast<int>(children.size()) < options.jobs)
      children.push_back(start(next++, work));
    std::vector<pollfd> fds;
    for (const Child& c : children) {
      fds.push_back({c.output, POLLIN, 0});
      fds.push_back({c.complaint, POLLIN, 0});
    }
    static_cast<void>(::poll(fds.data(), fds.size(), 250));
    for (std::size_t i = 0; i < children.size(); ++i) {
      Child& c = children[i];
      if (c.output >= 0 && fds[2 * i].revents != 0) drain(c.output, c.said, std::string::npos);
      if (c.complaint >= 0 && fds[2 * i + 1].revents != 0)
        drain(c.complaint, c.complained, complaint_max);
      const std::chrono::duration<double> taken = Clock::now() - c.started;
      if (!c.too_long && taken.count() > options.limit_s) {
        c.too_long = true;
        ::kill(c.pid, SIGKILL);
      }
    }
    std::erase_if(children, [&](Child& c) {
      if (c.output >= 0 || c.complaint >= 0) return false;
      done(c.index, finish(c, options.limit_s));
      return true;
    });
    idle();
  }
}

}  // namespace aureole
