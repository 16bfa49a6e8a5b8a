// fork, exec and pipes; see child_process.h.
#include "server/play/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

namespace aureole {
namespace {

[[noreturn]] void become(const char* executable, char* const* arguments, pid_t parent, int out,
                         int error) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent ended before the line above

  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(error, STDERR_FILENO);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  execv(executable, arguments);
  std::fprintf(stderr, "%s cannot be started: %s\n", executable, std::strerror(errno));
  _exit(127);
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::filesystem::path& executable,
                                         const std::vector<std::string>& arguments) {
  std::vector<std::string> words{executable.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  int out[2], error[2];
  if (pipe2(out, O_CLOEXEC) != 0) return Error::format("no pipe: {}", std::strerror(errno));
  if (pipe2(error, O_CLOEXEC) != 0) {
    const int reason = errno;
    close(out[0]);
    close(out[1]);
    return Error::format("no pipe: {}", std::strerror(reason));
  }
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) become(words[0].c_str(), pointers.data(), parent, out[1], error[1]);
  const int reason = errno;
  close(out[1]);
  close(error[1]);

  ChildProcess child;
  child.pipes_[0].fd = out[0];
  child.pipes_[1].fd = error[0];
  if (pid < 0) return Error::format("no new process: {}", std::strerror(reason));
  child.pid_ = pid;
  setpgid(pid, pid);  // here too: whoever comes first
  fcntl(out[0], F_SETFL, O_NONBLOCK);
  fcntl(error[0], F_SETFL, O_NONBLOCK);
  return child;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      wait_status_(other.wait_status_),
      pipes_(std::exchange(other.pipes_, {})) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(wait_status_, other.wait_status_);
  std::swap(pipes_, other.pipes_);
  return *this;
}

ChildProcess::~ChildProcess() {
  for (auto& pipe : pipes_) {
    if (pipe.fd >= 0) close(pipe.fd);
  }
  if (pid_ > 0 && is_running()) {
    signal(SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
}

void ChildProcess::read(Output which, const std::function<void(const std::string&)>& line) {
  Pipe& pipe = pipes_[static_cast<std::size_t>(which)];
  std::array<char, 16'384> part;
  while (pipe.fd >= 0) {
    const ssize_t n = ::read(pipe.fd, part.data(), part.size());
    if (n > 0) {
      pipe.lines.add({part.data(), static_cast<std::size_t>(n)}, line);
    } else if (n < 0 && errno == EINTR) {
      continue;
    } else if (n < 0 && errno == EAGAIN) {
      return;
    } else {
      pipe.lines.finish(line);
      close(pipe.fd);
      pipe.fd = -1;
    }
  }
}

bool ChildProcess::is_running() {
  if (wait_status_) return false;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return true;
  wait_status_ = status;
  return false;
}

std::string ChildProcess::how_it_ended() const {
  const int status = wait_status_.value_or(0);
  if (WIFSIGNALED(status)) return fmt::format("killed by signal {}", WTERMSIG(status));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

void ChildProcess::signal(int number) const {
  // Not after it was waited for: its number may belong to someone else by then.
  if (!wait_status_) kill(-pid_, number);
}

}  // namespace aureole
