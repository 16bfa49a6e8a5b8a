// `aureole experiment real-time`: the workload on region servers with sockets and clocks, beside
// the same in virtual time, with warm caches and with cold ones.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/commands/commands.h"
#include "server/measure/experiment.h"
#include "server/measure/real_time.h"
#include "server/ops/process/installation.h"

namespace aureole {
namespace {

struct Options {
  ExperimentOptions experiment;
  std::string json;
};

std::string list_of(const nlohmann::json& values) {
  std::string list;
  for (const auto& value : values) list += fmt::format("{:>8.2f}", value.get<double>());
  return list;
}

std::int64_t sum_of(const nlohmann::json& values) {
  std::int64_t sum = 0;
  for (const auto& value : values) sum += value.get<std::int64_t>();
  return sum;
}

void print_report(const nlohmann::json& report) {
  fmt::print(
      "CPU time of each server's thread for each tick (ms): in processes with their sockets, and "
      "in\nvirtual time without them, where every frame finds the caches as the frame before left "
      "them\n(warm), or cold, as a server does that has slept until its next tick.\n"
      "{:>5} {:>8} {:>8} {:>7} {:>8} {:>7} {:>9} {:>7}   {}\n",
      "t, s", "real", "warm", "/ warm", "cold", "/ cold", "longest", "skipped",
      "servers in real time | in virtual time, cold");
  for (const auto& row : report["buckets"])
    fmt::print("{:>5.0f} {:>8.2f} {:>8.2f} {:>7.2f} {:>8.2f} {:>7.2f} {:>9.2f} {:>7}  {} |{}\n",
               row["t_end_s"].get<double>(), row["worst_server_ms"].get<double>(),
               row["virtual_worst_server_ms"].get<double>(), row["ratio"].get<double>(),
               row["cold_worst_server_ms"].get<double>(), row["ratio_cold"].get<double>(),
               row["longest_step_ms"].get<double>(), sum_of(row["skipped_ticks"]),
               list_of(row["server_ms"]), list_of(row["cold_server_ms"]));
}

int run(const Options& o) {
  auto world = workload_world(o.experiment.workload);
  if (!world) return complain(exit_usage, world.error().message);
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  if (o.experiment.workload.servers > cores)
    return complain(exit_usage,
                    fmt::format("{} servers in real time need as many cores; this machine has {}",
                                o.experiment.workload.servers, cores));
  world->mode = migration_mode_from(o.experiment.mode).value_or(MigrationMode::adaptive);
  std::ofstream file;
  if (!o.json.empty()) {
    file.open(o.json);
    if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  }
  double said_s = -1;
  const auto progress = [&](const std::string& what) {
    const double at_s = static_cast<double>(std::time(nullptr));
    if (at_s - said_s < 10) return;
    said_s = at_s;
    fmt::print(stderr, "{}\n", what);
  };
  RealTimeOptions real_time;
  real_time.executable = executable_path();
  real_time.seconds = o.experiment.workload.seconds;
  // One after the other: each has the machine for itself.
  const auto real = run_in_real_time(*world, real_time, progress);
  if (!real) return complain(exit_failed, real.error().message);
  const auto in_virtual_time = run_experiment(o.experiment, progress);
  if (!in_virtual_time) return complain(exit_failed, in_virtual_time.error().message);
  ExperimentOptions cold = o.experiment;
  cold.cold_caches_s = cold.workload.seconds;
  const auto with_cold_caches = run_experiment(cold, progress);
  if (!with_cold_caches) return complain(exit_failed, with_cold_caches.error().message);
  const nlohmann::json report =
      compare_with_virtual_time(*real, *in_virtual_time, *with_cold_caches);
  print_report(report);
  if (o.json.empty()) return exit_ok;
  file << report.dump(2) << '\n';
  file.close();
  if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  return exit_ok;
}

}  // namespace

void add_real_time(CLI::App& experiment, int& exit_code) {
  CLI::App* command = experiment.add_subcommand(
      "real-time",
      "Runs the workload on region servers of their own, as many as there are cores at most, and\n"
      "then in virtual time, with warm caches and with cold ones, and compares what each server's\n"
      "thread spends in a tick.");
  const auto o = std::make_shared<Options>();
  ExperimentOptions& e = o->experiment;
  e.judged = e.with_references = false;
  WorkloadOptions& w = e.workload;
  command->add_option("layout", w.layout, "column, corner or grid")
      ->capture_default_str()
      ->check(CLI::IsMember({"column", "corner", "grid"}));
  command->add_option("--servers", w.servers, "How many regions")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command->add_option("--mode", e.mode, "naive, paper or adaptive")
      ->capture_default_str()
      ->check(CLI::IsMember({"naive", "paper", "adaptive"}));
  command->add_option("--seconds", w.seconds, "World time, and as long by the clock")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 3600.0));
  command->add_option("--rate", w.rate_per_s, "Bodies a second; on a grid, for every four regions")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 10'000.0));
  command->add_option("--seed", w.seed, "Of bodies and network")->capture_default_str();
  command->add_option("--json", o->json, "Write all figures to this file");
  command->callback([o, &exit_code] { exit_code = run(*o); });
}

}  // namespace aureole
