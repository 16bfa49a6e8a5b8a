// One poll() loop over the children's outputs and the signals; see supervisor.h.
#include "server/play/supervisor.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>

#include "server/base/check.h"
#include "server/ops/http_get.h"
#include "server/ops/logging.h"
#include "server/play/child_process.h"
#include "server/play/restart_limit.h"

namespace aureole {
namespace {

constexpr int health_limit_ms = 200;  // a signal waits no longer than this
constexpr int health_pause_ms = 50;

std::int64_t now_ms() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

/// Writes a line unless whoever reads it has stopped reading: then it is left out, because a paused
/// terminal must not hold up the world.
void write_line(const std::string& line) {
  pollfd room{STDERR_FILENO, POLLOUT, 0};
  if (poll(&room, 1, 0) != 1 || (room.revents & POLLOUT) == 0) return;
  const std::string whole = line + "\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, whole.data(), whole.size());
}

/// SIGINT, SIGTERM, SIGHUP and SIGCHLD as something to poll.
class SignalQueue {
 public:
  SignalQueue() {
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&set, number);
    sigprocmask(SIG_BLOCK, &set, nullptr);
    fd_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    AUREOLE_CHECK(fd_ >= 0, "a signalfd can be made");
  }
  SignalQueue(const SignalQueue&) = delete;
  SignalQueue& operator=(const SignalQueue&) = delete;
  ~SignalQueue() { close(fd_); }

  int descriptor() const { return fd_; }
  /// Empties the queue; whether one of them asks to stop.
  bool stop_asked() {
    bool stop = false;
    signalfd_siginfo info;
    while (read(fd_, &info, sizeof info) == sizeof info) stop |= info.ssi_signo != SIGCHLD;
    return stop;
  }

 private:
  int fd_ = -1;
};

struct Member {
  ProcessPlan plan;
  ChildProcess process;
  bool ready = false;
  std::string last_words;  ///< Newest line on stderr.
  RestartLimit restarts;
};

class World {
 public:
  World(const SupervisorOptions& options, const std::vector<ProcessPlan>& plan)
      : options_(options), plan_(plan) {}

  PlayOutcome run() {
    for (const auto& plan : plan_) {
      Result<ChildProcess> child = ChildProcess::start(options_.executable, plan.arguments);
      if (!child) {
        stop();
        return {PlayEnd::failed_at_start,
                fmt::format("{} could not be started: {}", plan.name, child.error().message)};
      }
      members_.push_back(
          {plan, std::move(*child), false, {}, RestartLimit(options_.restarts_per_minute, 60'000)});
    }
    std::optional<PlayOutcome> outcome;
    while (!outcome) {
      wait(open_ ? 1000 : health_pause_ms);
      if (signals_.stop_asked()) {
        outcome = PlayOutcome{};
        break;
      }
      outcome = look_for_ended();
      if (!outcome && !open_) outcome = try_to_open();
    }
    stop();
    return *outcome;
  }

 private:
  /// Until something happens, at most `limit_ms`; forwards what the children say.
  void wait(int limit_ms) {
    std::vector<pollfd> watched{{signals_.descriptor(), POLLIN, 0}};
    for (const auto& member : members_) {
      for (const Output which : {Output::standard, Output::error}) {
        watched.push_back(
            {member.process.descriptor(which), POLLIN, 0});  // negative ones are skipped
      }
    }
    poll(watched.data(), watched.size(), limit_ms);
    for (auto& member : members_) forward(member);
  }

  void forward(Member& member) {
    member.process.read(Output::standard, [&](const std::string& line) {
      if (line.rfind("ready ", 0) == 0) {
        member.ready = true;
      } else {
        write_line(line_with_role(member.plan.name, line));
      }
    });
    member.process.read(Output::error, [&](const std::string& line) {
      if (!line.empty()) member.last_words = line;
      // While all of them stop, each would only tell that it has lost the others.
      if (!stopping_) write_line(line_with_role(member.plan.name, line));
    });
  }

  std::optional<PlayOutcome> look_for_ended() {
    for (auto& member : members_) {
      if (member.process.is_running()) continue;
      forward(member);  // its last lines may have come after the last look
      const std::string end =
          fmt::format("{} ended ({})", member.plan.name, member.process.how_it_ended());
      if (!open_) {
        const auto why =
            member.last_words.empty() ? "without a word" : "and said: " + member.last_words;
        return PlayOutcome{PlayEnd::failed_at_start,
                           fmt::format("{} while the world was starting, {}", end, why)};
      }
      if (!member.restarts.allow(now_ms())) {
        return PlayOutcome{PlayEnd::failed_later,
                           fmt::format("{} too often within a minute: the world is stopped", end)};
      }
      write_line(fmt::format("play: {}; starting it again", end));
      Result<ChildProcess> child = ChildProcess::start(options_.executable, member.plan.arguments);
      if (!child) return PlayOutcome{PlayEnd::failed_later, child.error().message};
      member.process = std::move(*child);
    }
    return std::nullopt;
  }

  std::optional<PlayOutcome> try_to_open() {
    const auto silent =
        std::find_if(members_.begin(), members_.end(), [](const Member& m) { return !m.ready; });
    if (silent == members_.end()) {
      const Result<HttpAnswer> health = http_get(options_.health_url, health_limit_ms);
      if (health && health->status == 200) {
        open_ = true;
        fmt::print("Open {}\n", options_.page_url);
        std::fflush(stdout);
        return std::nullopt;
      }
      health_ = health ? fmt::format("{} answers {} {}", options_.health_url, health->status,
                                     health->body)
                       : health.error().message;
    }
    if (now_ms() - started_ms_ < options_.start_limit_ms) return std::nullopt;
    return PlayOutcome{
        PlayEnd::failed_at_start,
        fmt::format("the world was not ready within {} s: {}", options_.start_limit_ms / 1000,
                    silent == members_.end() ? health_ : silent->plan.name + " is not ready")};
  }

  void stop() {
    stopping_ = true;
    for (const auto& member : members_) member.process.signal(SIGTERM);
    const std::int64_t kill_at_ms = now_ms() + options_.stop_limit_ms;
    while (any_running() && now_ms() < kill_at_ms) wait(20);
    for (auto& member : members_) {
      if (member.process.is_running()) {
        write_line(fmt::format("play: {} did not stop when asked; killed", member.plan.name));
      }
      forward(member);
    }
    members_.clear();  // kills and waits for whatever still runs
  }

  bool any_running() {
    return std::any_of(members_.begin(), members_.end(),
                       [](Member& m) { return m.process.is_running(); });
  }

  const SupervisorOptions& options_;
  const std::vector<ProcessPlan>& plan_;
  SignalQueue signals_;
  std::vector<Member> members_;
  std::int64_t started_ms_ = now_ms();
  bool open_ = false;
  bool stopping_ = false;
  std::string health_;
};

}  // namespace

PlayOutcome run_world(const SupervisorOptions& options, const std::vector<ProcessPlan>& plan) {
  std::signal(SIGPIPE, SIG_IGN);
  return World(options, plan).run();
}

}  // namespace aureole
