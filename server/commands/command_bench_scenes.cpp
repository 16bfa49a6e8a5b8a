// `aureole bench`: the scenes that measure parts of a server's frame.
#include <CLI/CLI.hpp>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/bench/bench.h"
#include "server/commands/commands.h"

namespace aureole {
namespace {

struct Options {
  BenchOptions bench;
  std::string json;
};

int run(const BenchScene& scene, const Options& options) {
  std::ofstream file;
  if (!options.json.empty()) {
    // Before time is spent on what could not be written.
    file.open(options.json);
    if (!file) return complain(exit_failed, fmt::format("cannot write {}", options.json));
  }
  const std::vector<BenchRow> rows = scene.run(options.bench);
  fmt::print("{}", table_of(rows));
  if (options.json.empty()) return exit_ok;
  file << json_of(scene, options.bench, rows).dump(2) << '\n';
  file.close();
  if (!file) return complain(exit_failed, fmt::format("cannot write {}", options.json));
  return exit_ok;
}

void add_scene(CLI::App& bench, const BenchScene& scene, int& exit_code) {
  CLI::App* command = bench.add_subcommand(std::string(scene.name), std::string(scene.what));
  const auto options = std::make_shared<Options>();
  BenchOptions& o = options->bench;
  command->add_option("--bodies", o.bodies, "About so many to a server")
      ->capture_default_str()
      ->check(CLI::Range(10, 20'000));
  command
      ->add_option("--seconds", o.seconds,
                   "World time before anything is measured; they come all the while")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 600.0));
  command->add_option("--ticks", o.ticks, "Ticks that are measured in each repeat")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  command->add_option("--repeats", o.repeats, "Each from the same beginning")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--seed", o.seed, "Of where and how bodies come")->capture_default_str();
  command->add_option("--json", options->json, "Also write the figures to this file");
  command->callback([options, &scene, &exit_code] { exit_code = run(scene, *options); });
}

}  // namespace

void add_bench_scenes(CLI::App& bench, int& exit_code) {
  for (const BenchScene& scene : bench_scenes()) add_scene(bench, scene, exit_code);
}

}  // namespace aureole
