// The same workload in real time: region servers as processes of their own, with sockets and
// clocks.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/worlds/world.h"

namespace aureole {

struct RealTimeOptions {
  std::filesystem::path executable;  ///< `aureole`
  double seconds = 60;
  double start_limit_s = 30;  ///< For all to be linked.
};

/// What one server did in one bucket of 5 s of world time.
struct RealTimeBucket {
  double t_end_s = 0;
  /// CPU time of its thread for each tick that it took: all that it does, with its sockets.
  std::vector<double> server_ms;
  std::vector<std::uint64_t> bodies;  ///< At the end.
  /// Ticks that each server left out because it was behind: then others had its cores.
  std::vector<std::int64_t> skipped_ticks;
  /// Time on the clock, of a step: the longest of the last 8 s that any server tells of.
  double longest_step_ms = 0;
  /// Servers outside of any tolerance at the end, as they say themselves.
  std::size_t servers_outside = 0;
};

/// Nanoseconds that the first thread of a process has run. Errors: no such process, or a kernel
/// that does not say.
Result<std::int64_t> thread_cpu_of_process_ns(int pid);

/// Starts one process for each region and one gateway on this machine, on ports that are free, and
/// ends them all. A server has one thread, which is what is measured; with more servers than free
/// cores they wait for each other and leave ticks out. Errors: the world does not start, a process
/// ends, or a server left out more than half of a bucket's ticks.
Result<std::vector<RealTimeBucket>> run_in_real_time(
    const WorldDefinition& world, const RealTimeOptions& options,
    const std::function<void(const std::string&)>& progress);

/// `buckets` of all three, side by side. `report`: that of the run in virtual time; `cold`: that of
/// the same run with cold caches throughout. A server that steps every 16 ms sleeps most of the
/// time while it has little to do, and finds its caches used by others: `cold` is fairer then.
nlohmann::json compare_with_virtual_time(const std::vector<RealTimeBucket>& real,
                                         const nlohmann::json& report, const nlohmann::json& cold);

}  // namespace aureole
