// `aureole experiment figures`: all runs of the paper's figures and of the studies, then the plots.
#include <fmt/core.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <memory>

#include "server/commands/commands.h"
#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/runner.h"
#include "server/measure/figures/tables.h"

namespace aureole {
namespace {

struct Options {
  std::string out;
  std::vector<std::string> only;
  PlanOptions plan;
  int jobs = 1;
  bool plots_only = false, any_build = false;
};

/// What is running now: rewritten in place on a terminal, a line a minute elsewhere.
class StatusLine {
 public:
  void show(const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < (terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(60)))
      return;
    shown_ = now;
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", what, terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
  void say(const std::string& line) const {
    fmt::print(stderr, "{}{}\n", terminal_ ? "\r\x1b[K" : "", line);
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

/// SIGINT, SIGTERM and SIGHUP as something to poll.
class StopDescriptor {
 public:
  StopDescriptor() {
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, number);
    sigprocmask(SIG_BLOCK, &set, &before_);
    fd_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  StopDescriptor(const StopDescriptor&) = delete;
  StopDescriptor& operator=(const StopDescriptor&) = delete;
  ~StopDescriptor() {
    if (fd_ >= 0) {
      signalfd_siginfo taken;
      while (read(fd_, &taken, sizeof taken) == sizeof taken) {
      }
      close(fd_);
    }
    sigprocmask(SIG_SETMASK, &before_, nullptr);
  }
  int get() const { return fd_; }

 private:
  sigset_t before_{};
  int fd_ = -1;
};

Result<RunnerOutcome> make_runs(const Options& o) {
  // This very executable, also when another one has been built in its place hours later.
  const std::string self = fmt::format("/proc/{}/exe", getpid());
  const auto build = build_version(self);
  if (!build) return build.error();
  const StopDescriptor stop;
  StatusLine status;
  const RunnerReport report{[&](const std::string& line) { status.say(line); },
                            [&](const std::string& what) { status.show(what); }};
  return run_plan(plan_of(o.plan), {self, *build, o.out, o.jobs, o.any_build, stop.get()}, report);
}

/// Figures and tables from what lies in DIR/runs. Whether all could be written.
bool draw_all(const Options& o) {
  std::vector<std::string> notes;
  const auto runs = read_runs(o.out, o.plan.only, notes);
  bool well = true;
  std::size_t drawn = 0;
  for (const Figure& figure : figures_of(runs, notes)) {
    if (auto done = draw(figure, o.out); !done) {
      well = false;
      complain(exit_failed, done.error().message);
    } else {
      ++drawn;
    }
  }
  const auto page = std::filesystem::path(o.out) / "tables.md";
  if (auto written = write_whole(page, tables_of(runs, notes)); !written) {
    well = false;
    complain(exit_failed, written.error().message);
  }
  for (const std::string& note : notes) fmt::print("{}\n", note);
  std::size_t failed = 0;
  for (const BarResult& bar : bars_of(runs)) failed += bar.verdict == Verdict::failed ? 1 : 0;
  fmt::print("{} figures in {} and {} from {} runs; {} demands not met\n", drawn, o.out,
             page.string(), runs.size(), failed);
  return well;
}

int run(Options& o) {
  for (const std::string& word : o.only) {
    const auto study = study_from(word);
    if (!study)
      return complain(
          exit_usage,
          fmt::format("--only knows fig5, fig7, latency, tolerances, weak and regions, not {}",
                      word));
    o.plan.only.push_back(*study);
  }
  if (plan_of(o.plan).empty())
    return complain(exit_usage, "the plan has no runs with so many servers in what --only names");
  if (const auto found = find_gnuplot(); !found) return complain(exit_usage, found.error().message);
  if (o.plots_only && !std::filesystem::is_directory(std::filesystem::path(o.out) / "runs"))
    return complain(exit_usage,
                    fmt::format("there are no runs in {}: --plots-only draws those that "
                                "were made before with the same --out",
                                o.out));
  bool well = true;
  if (!o.plots_only) {
    const auto outcome = make_runs(o);
    if (!outcome) return complain(exit_failed, outcome.error().message);
    if (outcome->stopped)
      return complain(exit_failed,
                      fmt::format("stopped; {} runs are in {}, and the same command goes on there",
                                  outcome->made + outcome->already, o.out));
    fmt::print("{} runs made, {} already there, {} failed\n", outcome->made, outcome->already,
               outcome->failed);
    well = outcome->failed == 0;
  }
  return draw_all(o) && well ? exit_ok : exit_failed;
}

}  // namespace

void add_experiment_figures(CLI::App& experiment, int& exit_code) {
  CLI::App* command = experiment.add_subcommand(
      "figures",
      "Makes all runs of the paper's figures and of the studies (hours; --quick: half an hour),\n"
      "then draws them as SVG with gnuplot, and judges them in tables.md. Started again it goes\n"
      "on where it was stopped.");
  // An argument that is required would take the word "figures" for itself, so that whether there is
  // a layout is looked at when all words have been read.
  CLI::Option* const layout = experiment.get_option("layout");
  const bool wanted = layout->get_required();
  layout->required(false);
  experiment.parse_complete_callback([&experiment, command, layout, wanted] {
    if (wanted && experiment.get_subcommands().empty() && layout->count() == 0)
      throw CLI::RequiredError("layout");
    if (!experiment.got_subcommand(command)) return;
    for (const CLI::Option* option : experiment.get_options())
      if (option->count() > 0)
        throw CLI::ValidationError(
            option->get_name(),
            "is for one run and cannot stand before `figures`, which makes many");
    experiment.callback({});
  });
  const auto o = std::make_shared<Options>();
  command->add_option("--out", o->out, "Folder for figures and tables.md; the runs go to its runs/")
      ->required();
  command->add_option("--only", o->only, "Some of fig5,fig7,latency,tolerances,weak,regions")
      ->delimiter(',');
  command
      ->add_option("--servers", o->plan.servers,
                   "Make only runs with these numbers of servers: 1,2,4,10")
      ->delimiter(',')
      ->check(CLI::Range(1, 64));
  command->add_flag("--quick", o->plan.quick, "Fewer and shorter runs, each once");
  command->add_option("--seconds", o->plan.seconds, "World time of every run, not the plan's")
      ->check(CLI::Range(0.5, 3600.0));
  command
      ->add_option("--rate", o->plan.rate_per_s,
                   "Bodies a second in every run, not the plan's; on grids for every 4 servers")
      ->check(CLI::Range(1.0, 600.0));
  command
      ->add_option("--repeat", o->plan.repeats,
                   "Repeats, not the plan's, of every run but those of `paper` in fig5 and fig7")
      ->check(CLI::Range(1, 100));
  command->add_option("--seed", o->plan.seed, "Of bodies and network")->capture_default_str();
  command
      ->add_option("--jobs", o->jobs,
                   "Runs at a time. They take caches and memory from each other: frame times that\n"
                   "go into a figure want 1. Where there are more processors each has one to itself")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command->add_flag("--plots-only", o->plots_only, "Only draw and judge what lies in DIR/runs");
  command->add_flag("--any-build", o->any_build,
                    "Keep runs with the same command line that another build has made");
  command->callback([o, &exit_code] { exit_code = run(*o); });
}

}  // namespace aureole
