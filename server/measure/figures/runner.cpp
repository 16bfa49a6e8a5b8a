// One poll() loop over the processes that run; see runner.h.
#include "server/measure/figures/runner.h"

#include <fmt/format.h>
#include <poll.h>

#include <chrono>
#include <csignal>
#include <deque>
#include <memory>
#include <optional>
#include <thread>

#include "server/measure/figures/own_processors.h"
#include "server/measure/figures/run_files.h"
#include "server/play/child_process.h"

namespace aureole {
namespace {

constexpr std::size_t last_lines = 8;  ///< Of a run that failed.
constexpr int stop_limit_ms = 1000;    ///< From SIGTERM to SIGKILL.

double now_s() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

struct Job {
  const PlannedRun* run;
  std::filesystem::path part;  ///< Where the process writes.
  ChildProcess process;
  std::deque<std::string> lines;  ///< The last ones that it said.
  double began_s;
  std::optional<int> processor;  ///< That it has to itself.
};

class Runner {
 public:
  Runner(const std::vector<PlannedRun>& plan, const RunnerOptions& options,
         const RunnerReport& report)
      : options_(options),
        report_(report),
        all_(plan.size()),
        processors_(static_cast<std::size_t>(options.jobs)) {
    for (const PlannedRun& run : plan) {
      if (is_there(run)) {
        ++outcome_.already;
      } else {
        waiting_.push_back(&run);
        cost_left_ += run.cost();
      }
    }
  }

  Result<RunnerOutcome> go() {
    if (outcome_.already > 0)
      report_.say(fmt::format("{} of {} runs are already there: made with the same command line{}",
                              outcome_.already, all_,
                              options_.any_build ? "" : " by the same build"));
    began_s_ = now_s();
    while (!waiting_.empty() || !jobs_.empty()) {
      while (!waiting_.empty() && jobs_.size() < static_cast<std::size_t>(options_.jobs))
        if (auto started = start_next(); !started) return started.error();
      if (wait()) {
        outcome_.stopped = true;
        stop();
        return outcome_;
      }
      if (auto ended = look_for_ended(); !ended) return ended.error();
      report_.show(status());
    }
    return outcome_;
  }

 private:
  bool is_there(const PlannedRun& run) const {
    const auto found = read_run(run_file(options_.out, run));
    return found && found->arguments == run.arguments() &&
           (options_.any_build || found->build == options_.build);
  }

  Status start_next() {
    const PlannedRun& run = *waiting_.front();
    waiting_.pop_front();
    std::filesystem::path part = run_file(options_.out, run);
    part += ".child";
    std::error_code problem;
    std::filesystem::remove(part, problem);
    auto arguments = run.arguments();
    arguments.insert(arguments.end(), {"--json", part.string()});
    auto process = ChildProcess::start(options_.executable, arguments);
    if (!process) return process.error();
    const std::optional<int> processor = processors_.take(process->pid());
    jobs_.push_back({&run, std::move(part), std::move(*process), {}, now_s(), processor});
    return Ok{};
  }

  /// Until a process says something or ends, or for a moment. Whether to stop.
  bool wait() {
    std::vector<pollfd> watched{{options_.stop_fd, POLLIN, 0}};
    for (const Job& job : jobs_)
      for (const Output which : {Output::standard, Output::error})
        watched.push_back({job.process.descriptor(which), POLLIN, 0});  // -1 is skipped
    poll(watched.data(), watched.size(), 200);
    for (Job& job : jobs_) listen(job);
    return watched.front().revents != 0;
  }

  static void listen(Job& job) {
    for (const Output which : {Output::standard, Output::error})
      job.process.read(which, [&](const std::string& line) {
        if (line.empty()) return;
        job.lines.push_back(line);
        if (job.lines.size() > last_lines) job.lines.pop_front();
      });
  }

  Status look_for_ended() {
    for (std::size_t i = 0; i < jobs_.size();) {
      Job& job = jobs_[i];
      if (job.process.is_running()) {
        ++i;
        continue;
      }
      listen(job);
      auto kept = keep(job);
      std::error_code problem;
      std::filesystem::remove(job.part, problem);
      if (!kept) return kept.error();
      processors_.give_back(job.processor);
      cost_left_ -= job.run->cost();
      cost_done_ += job.run->cost();
      jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return Ok{};
  }

  /// Errors: the run is well but cannot be written; then no other one could.
  Status keep(const Job& job) {
    const std::string end = job.process.how_it_ended();
    auto report = end == "exit code 0"
                      ? read_report(job.part)
                      : Result<nlohmann::json>(Error::format("it ended with {}", end));
    if (!report) {
      ++outcome_.failed;
      report_.say(fmt::format("{} failed: {}\n  {}", job.run->name(), report.error().message,
                              command_line(job.run->arguments())));
      for (const std::string& line : job.lines) report_.say("  | " + line);
      return Ok{};
    }
    ++outcome_.made;
    report_.say(fmt::format("{}: made in {}", job.run->name(), in_words(now_s() - job.began_s)));
    return write_run(run_file(options_.out, *job.run),
                     {*job.run, job.run->arguments(), options_.build, std::move(*report)});
  }

  std::string status() const {
    std::string text =
        fmt::format("{} of {} runs done", all_ - waiting_.size() - jobs_.size(), all_);
    for (const Job& job : jobs_)
      text += fmt::format("; {} ({}{}{})", job.run->name(), in_words(now_s() - job.began_s),
                          job.lines.empty() ? "" : ", ", job.lines.empty() ? "" : job.lines.back());
    if (cost_done_ > 0 && cost_left_ > 0) {
      // What the present runs have already taken is in the time gone, not in the cost done.
      double begun_s = 0;
      for (const Job& job : jobs_) begun_s += now_s() - job.began_s;
      const double jobs = std::max<double>(1, static_cast<double>(jobs_.size()));
      const double gone_s = now_s() - began_s_ - begun_s / jobs;
      text +=
          fmt::format("; about {} left",
                      in_words(std::max(0.0, gone_s * cost_left_ / cost_done_ - begun_s / jobs)));
    }
    return text;
  }

  void stop() {
    for (const Job& job : jobs_) job.process.signal(SIGTERM);
    const double limit_s = now_s() + stop_limit_ms / 1e3;
    for (Job& job : jobs_)
      while (job.process.is_running() && now_s() < limit_s)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    for (const Job& job : jobs_) {
      std::error_code problem;
      std::filesystem::remove(job.part, problem);
    }
    jobs_.clear();
  }

  const RunnerOptions& options_;
  const RunnerReport& report_;
  std::size_t all_;
  OwnProcessors processors_;
  std::deque<const PlannedRun*> waiting_;
  std::vector<Job> jobs_;
  RunnerOutcome outcome_;
  double began_s_ = 0, cost_left_ = 0, cost_done_ = 0;
};

}  // namespace

Result<RunnerOutcome> run_plan(const std::vector<PlannedRun>& plan, const RunnerOptions& options,
                               const RunnerReport& report) {
  std::error_code problem;
  std::filesystem::create_directories(options.out / "runs", problem);
  if (problem)
    return Error::format("cannot make the folder {}: {}", (options.out / "runs").string(),
                         problem.message());
  return Runner(plan, options, report).go();
}

std::string command_line(const std::vector<std::string>& arguments) {
  std::string line = "aureole";
  for (const std::string& word : arguments) line += " " + word;
  return line;
}

std::string in_words(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 100) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  if (minutes < 100) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

}  // namespace aureole
