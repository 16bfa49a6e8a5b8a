// `aureole experiment`: the paper's workload on columns, corners or grids, with what every frame
// took.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/commands/commands.h"
#include "server/measure/experiment.h"
#include "server/measure/figures/run_ranges.h"

namespace aureole {
namespace {

struct Options {
  ExperimentOptions experiment;
  std::string tolerances = "fixed";
  std::string json;
};

/// A line on stderr: rewritten in place on a terminal, every 10 s elsewhere.
class Progress {
 public:
  void show(const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < (terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10)))
      return;
    shown_ = now;
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", what, terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
  void end() const {
    if (terminal_) fmt::print(stderr, "\r\x1b[K");
  }

 private:
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

std::string in_cell(const nlohmann::json& value, int digits) {
  return value.is_null() ? "–" : fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::uint64_t sum_of(const nlohmann::json& values) {
  std::uint64_t sum = 0;
  for (const auto& value : values) sum += value.get<std::uint64_t>();
  return sum;
}

void print_row(const nlohmann::json& row) {
  const nlohmann::json& split = row["split"];
  const nlohmann::json& missed = row["missed_interactions_in_tolerance"];
  fmt::print(
      "{:>5.0f} {:>8.2f} {:>8.2f} {:>8.2f} | {:>8.2f} {:>6.3f} {:>6.3f} {:>6.3f} | {:>7} {:>6} "
      "{:>6} {:>7.4f} {:>6} | {:>7} {:>6} {:>6}\n",
      row["t_end_s"].get<double>(), row["worst_server_ms"].get<double>(),
      row["max_frame_ms"].get<double>(), row["p99_frame_ms"].get<double>(),
      split["physics"].get<double>(), split["aura"].get<double>(), split["decide"].get<double>(),
      split["wire"].get<double>(), sum_of(row["bodies"]), sum_of(row["awake"]),
      row["migrations"].get<std::uint64_t>(), row["foreign_hosted_share"].get<double>(),
      missed.is_null() ? "–" : missed.dump(), in_cell(row["speedup"], 2),
      in_cell(row["efficiency"], 3), in_cell(row["efficiency_ideal"], 3));
}

void print_total(const nlohmann::json& total) {
  fmt::print("In their tolerances: {} of frames, {} of ticks\n",
             in_cell(total["frames_in_tolerance_share"], 4),
             in_cell(total["ticks_in_tolerance_share"], 4));
  if (total["wire"].is_null()) return;
  const auto &wire = total["wire"], &jump = total["handoff_jump_mm"];
  fmt::print(
      "For each that moves and tick: {} bytes of auras, {} of replicas (full states: {} of that "
      "on top)\n"
      "Handoffs moved bodies by {} mm (99 %), {} mm at most; {} samples\n",
      in_cell(wire["aura_bytes_per_moving_tick"], 1),
      in_cell(wire["replica_bytes_per_moving_tick"], 1), in_cell(wire["replica_key_share"], 3),
      in_cell(jump["p99"], 3), in_cell(jump["max"], 3), jump["samples"].get<std::size_t>());
}

/// How long the last two buckets are: 10 s, unless the run ends within one.
double last_s(const nlohmann::json& buckets) {
  const auto end_s = [&](std::size_t i) { return buckets[i]["t_end_s"].get<double>(); };
  const std::size_t count = buckets.size();
  return end_s(count - 1) - (count > 2 ? end_s(count - 3) : 0);
}

void print_report(const nlohmann::json& report) {
  fmt::print(
      "Thread CPU time of frames (ms); the split is that of the busiest server; missed: in "
      "tolerance.\n"
      "{:>5} {:>8} {:>8} {:>8} | {:>8} {:>6} {:>6} {:>6} | {:>7} {:>6} {:>6} {:>7} {:>6} | {:>7} "
      "{:>6} {:>6}\n",
      "t, s", "worst", "max", "p99", "physics", "aura", "decide", "wire", "bodies", "awake",
      "moved", "foreign", "missed", "speedup", "/ cut", "/ideal");
  for (const auto& row : report["buckets"]) print_row(row);
  const auto& last = report["last_10_s"];
  fmt::print(
      "Last {:g} s: {:.2f} ms, {:.1f} % of it besides physics; speedup {}, efficiency {}, against "
      "ideal {}\n",
      last_s(report["buckets"]), last["worst_server_ms"].get<double>(),
      last["share_besides_physics"].get<double>() * 100, in_cell(last["speedup"], 2),
      in_cell(last["efficiency"], 3), in_cell(last["efficiency_ideal"], 3));
  print_total(report["total"]);
  for (const auto& violation : report["violations"])
    fmt::print("  {}\n", violation.get<std::string>());
}

int run(Options o) {
  if (o.experiment.workload.layout.empty())
    return complain(exit_usage, "which layout? Expected column, corner or grid");
  o.experiment.follow_latency = o.tolerances == "follow";
  if (o.experiment.jitter_ms > o.experiment.latency_ms)
    return complain(exit_usage,
                    "--jitter-ms must not be more than --latency-ms, of which it is a part");
  if (auto world = workload_world(o.experiment.workload); !world)
    return complain(exit_usage, world.error().message);
  std::ofstream file;
  if (!o.json.empty()) {
    // Before minutes are spent on what could not be written.
    file.open(o.json);
    if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  }
  Progress progress;
  const auto report =
      run_experiment(o.experiment, [&](const std::string& what) { progress.show(what); });
  progress.end();
  if (!report) return complain(exit_failed, report.error().message);
  print_report(*report);
  if (o.json.empty()) return exit_ok;
  file << report->dump(2) << '\n';
  file.close();
  if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  return exit_ok;
}

CLI::Range in_range(run_ranges::Range range) {
  return CLI::Range(range.from, range.to);
}
/// For whole numbers: their sentence has no point in it.
CLI::Range in_whole_range(run_ranges::Range range) {
  return CLI::Range(static_cast<int>(range.from), static_cast<int>(range.to));
}

CLI::IsMember one_of(std::initializer_list<const char*> words) {
  return CLI::IsMember(std::vector<std::string>(words.begin(), words.end()));
}

void add_network_options(CLI::App& command, ExperimentOptions& e) {
  command.add_option("--latency-ms", e.latency_ms, "Longest time of a message")
      ->capture_default_str()
      ->check(in_range(run_ranges::message_ms));
  command.add_option("--jitter-ms", e.jitter_ms, "It takes this much less at most")
      ->capture_default_str()
      ->check(in_range(run_ranges::message_ms));
  command
      .add_option("--loss-pct", e.loss_pct,
                  "TCP segments that are lost, of a hundred: what comes after them waits until\n"
                  "they have been sent again")
      ->capture_default_str()
      ->check(in_range(run_ranges::loss_pct));
}

void add_tolerance_options(CLI::App& command, Options& o) {
  AuraTolerances& t = o.experiment.workload.tolerances;
  command.add_option("--speed-tolerance", t.speed_mps, "m/s, the fastest that auras reckon with")
      ->capture_default_str()
      ->check(in_range(run_ranges::speed_tolerance_mps));
  command.add_option("--latency-tolerance", t.latency_ms, "ms, likewise the longest latency")
      ->capture_default_str()
      ->check(in_range(run_ranges::latency_tolerance_ms));
  command.add_option("--frame-time-tolerance", t.frame_time_ms, "ms, likewise the longest frame")
      ->capture_default_str()
      ->check(in_range(run_ranges::frame_time_tolerance_ms));
  command
      .add_option("--tolerances", o.tolerances,
                  "fixed: as said; follow: the latency tolerance is what links measure, and more")
      ->capture_default_str()
      ->check(CLI::IsMember({"fixed", "follow"}));
}

}  // namespace

void add_experiment(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "experiment",
      "Runs the workload of the paper's experiments in virtual time, and measures what every\n"
      "server's frame takes.");
  const auto o = std::make_shared<Options>();
  ExperimentOptions& e = o->experiment;
  e.workload.layout.clear();
  command
      ->add_option("layout", e.workload.layout,
                   "column (1 to 10 servers), corner (1, 3, 4, 9), or grid (4, 9, 16 … 64)")
      ->check(one_of(run_ranges::layouts));
  command->add_option("--servers", e.workload.servers, "How many regions")
      ->capture_default_str()
      ->check(in_whole_range(run_ranges::servers));
  command
      ->add_option("--mode", e.mode,
                   "naive, paper, adaptive: servers that talk, beside single, cut and ideal;\n"
                   "single: one server for everything; ideal: worlds that do not talk;\n"
                   "cut: bodies are handed over at the boundary at once and for free")
      ->capture_default_str()
      ->check(one_of(run_ranges::modes));
  command->add_option("--seconds", e.workload.seconds, "World time; bodies come all the while")
      ->capture_default_str()
      ->check(in_range(run_ranges::seconds));
  command
      ->add_option("--rate", e.workload.rate_per_s,
                   "Bodies a second; on a grid, for every four regions")
      ->capture_default_str()
      ->check(in_range(run_ranges::rate_per_s));
  command
      ->add_option("--region", e.workload.region_m,
                   "m, edge of a region; volumes beside boundaries are 150 m long or less")
      ->capture_default_str()
      ->check(in_range(run_ranges::region_m));
  command->add_option("--seed", e.workload.seed, "Of bodies and network")->capture_default_str();
  command->add_option("--repeat", e.repeats, "Runs of the same, for the mean of their maxima")
      ->capture_default_str()
      ->check(in_whole_range(run_ranges::repeats));
  add_network_options(*command, e);
  add_tolerance_options(*command, *o);
  command->add_flag("--single,!--no-single", e.with_single,
                    "Also run everything on one server, for the speedup (on by default, but not\n"
                    "with more than 20,000 bodies)");
  command->add_flag("--references,!--no-references", e.with_references,
                    "Also run cut, ideal and single, to compare with (on by default)");
  command
      ->add_option("--reference-repeats", e.reference_repeats,
                   "Repeats that cut, ideal and single run beside, if not all: they take longer\n"
                   "than ours, and only maxima need many repeats")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--single-repeats", e.single_repeats,
                   "Of these repeats, how many single runs beside, if not all: it takes longer\n"
                   "than all others together")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option(
          "--cold-caches", e.cold_caches_s,
          "s: so long before the end every frame begins with cold caches, and each server\n"
          "has a heap of its own, so that many servers in one process, which share both,\n"
          "can be compared with few")
      ->capture_default_str()
      ->check(in_range(run_ranges::cold_caches_s));
  command->add_flag("--judge,!--no-judge", e.judged,
                    "Run it once more for the oracles to look at (on by default)");
  command->add_option("--json", o->json, "Write all figures to this file");
  // Beside the layouts: their names are taken for the subcommands'.
  add_real_time(*command, exit_code);
  command->callback([command, o, &exit_code] {
    // A subcommand does its own work.
    if (command->get_subcommands().empty()) exit_code = run(*o);
  });
  add_experiment_figures(*command, exit_code);
}

}  // namespace aureole
