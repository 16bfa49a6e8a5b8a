// The subcommands of `aureole`: each file beside this one adds one of them to the command line.
#pragma once

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <cstdio>
#include <string>

namespace aureole {

/// Each function adds one subcommand with its options. When that subcommand was chosen, its
/// callback runs it to the end and leaves the process's exit code in `exit_code`: 0 all went well,
/// 1 something failed while it ran, 2 the user gave something wrong (then one sentence has gone to
/// stderr). `exit_code` must outlive the parsing of the command line.
void add_play(CLI::App& app, int& exit_code);
void add_region(CLI::App& app, int& exit_code);
void add_gateway(CLI::App& app, int& exit_code);
void add_status(CLI::App& app, int& exit_code);
void add_bench(CLI::App& app, int& exit_code);
/// The scenes of server/bench below `bench`.
void add_bench_scenes(CLI::App& bench, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_experiment(CLI::App& app, int& exit_code);
/// Of `aureole experiment`.
void add_experiment_figures(CLI::App& experiment, int& exit_code);
void add_real_time(CLI::App& experiment, int& exit_code);

inline constexpr int exit_ok = 0;
inline constexpr int exit_failed = 1;
inline constexpr int exit_usage = 2;

/// Says what is wrong on stderr and returns the exit code.
inline int complain(int exit_code, const std::string& sentence) {
  fmt::print(stderr, "aureole: {}\n", sentence);
  return exit_code;
}

}  // namespace aureole
