// `aureole simulate`: many seeds of the fault simulation, judged by every rule, with a replay line
// for each one that fails.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "server/commands/commands.h"
#include "server/experiment/oracles/single_server_oracle.h"
#include "server/experiment/seed_processes.h"
#include "server/experiment/simulation.h"

namespace aureole {
namespace {

struct SimulateOptions {
  std::string layout = "corner4", mode = "adaptive", faults = "none", json;
  int seeds = 10;
  std::uint64_t first_seed = 1;
  double seconds = 20, latency_ms = 2, jitter_ms = 1;
  int bodies = 300;
  std::optional<double> latency_tolerance_ms;
  double level_from = LoadLevels::awake_min;
  std::optional<double> crowd_share;
  bool check_repeatable = false;
  bool compare_single = true;
  int jobs = 0;
  double limit_s = 600;
};

SimulationOptions of_seed(const SimulateOptions& o, std::uint64_t seed) {
  SimulationOptions options;
  options.scenario = {o.layout, *migration_mode_from(o.mode), seed, o.seconds,
                      o.bodies, o.latency_tolerance_ms};
  options.network = {static_cast<Micros>(o.latency_ms * 1000),
                     static_cast<Micros>(o.jitter_ms * 1000)};
  options.faults = *fault_kinds_from(o.faults);
  options.keep_trail = o.check_repeatable;
  options.pace.level_from = o.level_from;
  options.pace.crowd_share = o.crowd_share;
  return options;
}

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  if (word.find_first_not_of(
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./") ==
      std::string::npos)
    return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string replay_line(const SimulateOptions& o, std::uint64_t seed) {
  std::string line = fmt::format(
      "aureole simulate --layout {} --mode {} --seeds 1 --seed {} --seconds {} --latency-ms {} "
      "--jitter-ms {} --faults {} --bodies {}",
      quoted(o.layout), o.mode, seed, o.seconds, o.latency_ms, o.jitter_ms, o.faults, o.bodies);
  if (o.latency_tolerance_ms)
    line += fmt::format(" --latency-tolerance {}", *o.latency_tolerance_ms);
  if (o.level_from != LoadLevels::awake_min) line += fmt::format(" --level-from {}", o.level_from);
  if (o.crowd_share) line += fmt::format(" --crowd-share {}", *o.crowd_share);
  return line + (o.check_repeatable ? " --check-repeatable" : "");
}

std::string in_words(int seeds) {
  return fmt::format("{} seed{}", seeds, seeds == 1 ? "" : "s");
}

/// A line on stderr: rewritten in place on a terminal, every 10 s elsewhere.
class Progress {
 public:
  explicit Progress(int seeds) : seeds_(seeds), terminal_(::isatty(STDERR_FILENO) == 1) {}
  void show(const RunTotals& totals) {
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < (terminal_ ? std::chrono::milliseconds(500) : std::chrono::seconds(10)))
      return;
    shown_ = now;
    fmt::print(stderr, "{}{} of {}, {} failed{}", terminal_ ? "\r" : "", totals.seeds,
               in_words(seeds_), totals.failed_seeds, terminal_ ? "" : "\n");
    std::fflush(stderr);
  }
  void end() const {
    if (terminal_) fmt::print(stderr, "\r\x1b[K");
  }

 private:
  int seeds_;
  bool terminal_;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

/// What is known of all seeds so far, and the words about those that failed.
struct Report {
  const SimulateOptions& options;
  RunTotals totals;
  nlohmann::json seeds = nlohmann::json::array(), failures = nlohmann::json::array();
  std::map<std::uint64_t, SeedResult> first_runs;  ///< Of seeds whose second run is still out.

  void fail(std::uint64_t seed, const std::string& scenario,
            const std::vector<Violation>& violations) {
    nlohmann::json list = nlohmann::json::array();
    fmt::print("seed {} ({}) broke rules:\n", seed, scenario);
    for (const Violation& v : violations) {
      fmt::print("  {} at tick {}: {}\n", v.rule, v.tick, v.what);
      list.push_back({{"rule", v.rule}, {"tick", v.tick}, {"what", v.what}});
    }
    fmt::print("  replay: {}\n", replay_line(options, seed));
    failures.push_back({{"seed", seed},
                        {"scenario", scenario},
                        {"violations", list},
                        {"replay", replay_line(options, seed)}});
  }

  void ended_early(std::uint64_t seed, const std::string& how, std::int64_t tick = 0) {
    ++totals.seeds;
    ++totals.failed_seeds;
    ++totals.ended_early;
    fail(seed, "ended early", {{"ended early", tick, "the run " + how}});
  }

  void take(std::uint64_t seed, const ChildOutcome& outcome, bool again) {
    const std::int64_t tick = std::max<std::int64_t>(outcome.moment.tick, 0);
    if (!outcome.ended_well && again) {
      ++totals.hash_mismatches;
      return fail(seed, "run twice", {{"repeatable", tick, "the other run " + outcome.how}});
    }
    if (!outcome.ended_well) return ended_early(seed, outcome.how, tick);
    const auto json = nlohmann::json::parse(outcome.output, nullptr, false);
    if (json.is_discarded()) return ended_early(seed, "said nothing that can be read");
    if (json.contains("error")) return ended_early(seed, json["error"].get<std::string>());
    const auto result = seed_result_from(json);
    if (!result) return ended_early(seed, result.error().message);
    if (options.check_repeatable) {
      const auto [first, fresh] = first_runs.try_emplace(seed, *result);
      if (!fresh) {
        if (first->second.hash != result->hash) {
          ++totals.hash_mismatches;
          fail(seed, "run twice", {tell_difference(first->second, *result)});
        }
        first_runs.erase(first);
      }
    }
    if (again) return;
    totals.add(*result);
    seeds.push_back({{"seed", seed},
                     {"scenario", result->scenario},
                     {"hash", result->hash},
                     {"failed", !result->all_rules_held()},
                     {"cpu_s", result->cpu_s}});
    if (!result->all_rules_held()) fail(seed, result->scenario, result->violations);
  }

  bool all_held() const {
    return totals.failed_seeds == 0 && totals.hash_mismatches == 0 && totals.compared_failed == 0;
  }
};

nlohmann::json compare(const SimulateOptions& o) {
  const SimulationOptions of_any = of_seed(o, o.first_seed);
  nlohmann::json list = nlohmann::json::array();
  for (const Comparison& c : compare_with_single_server(of_any.scenario.mode, of_any.network))
    list.push_back({{"scene", c.scene},
                    {"measure", c.measure},
                    {"told", describe(c)},
                    {"where", c.where},
                    {"handoffs", c.handoffs},
                    {"stand_ins", c.stand_ins},
                    {"worst", c.worst},
                    {"limit", c.limit},
                    {"held", c.held()}});
  return list;
}

std::string compare_line(const SimulateOptions& o) {
  return replay_line(o, o.first_seed) + " --compare-single";
}

/// The scenes that are also run on one server: in a process of their own, like a seed.
nlohmann::json compare_in_process(const SimulateOptions& o, RunTotals& totals) {
  nlohmann::json list;
  run_in_processes(
      {1, 1, o.limit_s}, [&](int) { return compare(o).dump(); },
      [&](int, const ChildOutcome& outcome) {
        list = nlohmann::json::parse(outcome.output, nullptr, false);
        if (outcome.ended_well && list.is_array()) return;
        ++totals.compared;
        ++totals.compared_failed;
        fmt::print("the comparison with one server {}\n  replay: {}\n", outcome.how,
                   compare_line(o));
        list = nlohmann::json::array();
      });
  for (const auto& c : list) {
    ++totals.compared;
    if (c["held"].get<bool>()) continue;
    ++totals.compared_failed;
    fmt::print("compared with one server, {}\n  replay: {}\n", c["told"].get<std::string>(),
               compare_line(o));
  }
  return list;
}

void print_totals(const nlohmann::json& totals) {
  for (const auto& [name, value] : totals.items())
    if (value.is_number_float())
      fmt::print("  {:<36} {:.3f}\n", name, value.get<double>());
    else
      fmt::print("  {:<36} {}\n", name, value.dump());
}

int simulate_all(SimulateOptions o) {
  if (o.jitter_ms > o.latency_ms)
    return complain(exit_usage,
                    "--jitter-ms must not be more than --latency-ms, of which it is a "
                    "part");
  if (auto scenario = make_scenario(of_seed(o, o.first_seed).scenario); !scenario)
    return complain(exit_usage, scenario.error().message);
  std::ofstream file;
  if (!o.json.empty()) {
    // Before time is spent on what could not be written.
    file.open(o.json);
    if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  }
  if (o.jobs == 0) o.jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int runs = o.check_repeatable ? 2 : 1;
  const auto seed_of = [&](int i) { return o.first_seed + static_cast<std::uint64_t>(i / runs); };

  Report report{o, {}, nlohmann::json::array(), nlohmann::json::array(), {}};
  Progress progress(o.seeds);
  run_in_processes(
      {o.seeds * runs, o.jobs, o.limit_s},
      [&](int i) {
        const auto result = simulate(of_seed(o, seed_of(i)));
        if (!result) return nlohmann::json{{"error", result.error().message}}.dump();
        return to_json(*result).dump();
      },
      [&](int i, const ChildOutcome& outcome) {
        progress.end();
        report.take(seed_of(i), outcome, i % runs > 0);
      },
      [&] { progress.show(report.totals); });
  progress.end();
  const nlohmann::json comparisons =
      o.compare_single ? compare_in_process(o, report.totals) : nlohmann::json::array();

  const nlohmann::json totals = report.totals.to_json();
  fmt::print("{} {}, {} from {}, {} s, {} ms, faults {}:\n", o.layout, o.mode, in_words(o.seeds),
             o.first_seed, o.seconds, o.latency_ms, o.faults);
  print_totals(totals);
  if (!o.json.empty()) {
    nlohmann::json all = totals;
    all["layout"] = o.layout;
    all["mode"] = o.mode;
    all["faults"] = o.faults;
    all["comparisons"] = comparisons;
    all["per_seed"] = report.seeds;
    all["failures"] = report.failures;
    file << all.dump(2) << '\n';
    file.close();
    if (!file) return complain(exit_failed, fmt::format("cannot write {}", o.json));
  }
  return report.all_held() ? exit_ok : exit_failed;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Runs region cores under virtual time, a simulated network and faults, and judges every "
      "tick.");
  const auto o = std::make_shared<SimulateOptions>();
  command
      ->add_option("--layout", o->layout, layout_names() + ", or a world file or its shipped name")
      ->capture_default_str();
  command->add_option("--mode", o->mode, "Which bodies are hosted where")
      ->capture_default_str()
      ->check(CLI::IsMember({"naive", "paper", "adaptive"}));
  command->add_option("--seeds", o->seeds, "How many seeds")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  command->add_option("--seed", o->first_seed, "The first one")->capture_default_str();
  command->add_option("--seconds", o->seconds, "World time of each; faults stop at 60 % of it")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 3600.0));
  command->add_option("--latency-ms", o->latency_ms, "Longest time of an undisturbed message")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--jitter-ms", o->jitter_ms, "It takes this much less at most")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--faults", o->faults, "What goes wrong")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "links", "crashes", "all"}));
  command->add_option("--bodies", o->bodies, "Bodies of a built-in layout, about")
      ->capture_default_str()
      ->check(CLI::Range(1, 20'000));
  command
      ->add_option("--latency-tolerance", o->latency_tolerance_ms,
                   "ms, the longest latency that auras reckon with (else the world's)")
      ->check(CLI::Range(0.0, 1000.0));
  command
      ->add_option("--level-from", o->level_from,
                   "Bodies awake from which on servers are ordered by their loads; in a row of "
                   "regions half as many move lines, and below 128 out of any crowd")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e9));
  command
      ->add_option("--crowd-share", o->crowd_share,
                   "In a row of regions lines leave crowds of at most this share of all that is "
                   "awake, and share out larger ones (else 0.08, or what --level-from says)")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--json", o->json, "Write totals and failures to this file");
  command->add_flag("--check-repeatable", o->check_repeatable,
                    "Run each seed twice and compare their hashes");
  command->add_flag("--compare-single,!--no-compare-single", o->compare_single,
                    "Also run scenes on one server and on four, and compare (on by default)");
  command->add_option("--jobs", o->jobs, "Processes at a time (0: as many as cores)")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  command->add_option("--limit-s", o->limit_s, "A seed that takes longer has failed")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 86'400.0));
  command->callback([o, &exit_code] { exit_code = simulate_all(*o); });
}

}  // namespace aureole
