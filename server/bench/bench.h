// `aureole bench`: named scenes that measure what one part of a server's frame takes.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace aureole {

struct BenchOptions {
  int bodies = 1000;    ///< About so many; see Situation.
  double seconds = 10;  ///< World time that goes by before anything is measured.
  int ticks = 125;      ///< Ticks that are measured, in each repeat.
  int repeats = 3;
  std::uint64_t seed = 1;
};

/// The middle of what was measured, and how far it spreads. Unit: µs of thread CPU time.
struct Spread {
  double median_us = 0, p10_us = 0, p90_us = 0;
};
/// Requires samples; sorts them.
Spread spread_of(std::vector<double>& samples_us);

/// One line of a scene's table.
struct BenchRow {
  std::string situation;  ///< Which bodies: "workload", "settled", "flight", or a group's size.
  std::string operation;
  double bodies = 0;  ///< In one operation, mean over the operations.
  double awake = 0;   ///< Of these.
  std::size_t samples = 0;
  Spread cpu;
  /// Bytes that one operation makes or reads, mean; 0 if it has nothing to do with bytes.
  double bytes = 0;
  std::string note;  ///< For people; may be empty.
};

struct BenchScene {
  std::string_view name;
  std::string_view what;  ///< A sentence for --list.
  std::vector<BenchRow> (*run)(const BenchOptions&);
};
std::span<const BenchScene> bench_scenes();
/// Null: there is none of that name.
const BenchScene* find_bench_scene(std::string_view name);

std::string table_of(std::span<const BenchRow> rows);
nlohmann::json json_of(const BenchScene& scene, const BenchOptions& options,
                       std::span<const BenchRow> rows);

// The scenes, a file each.
std::vector<BenchRow> bench_physics(const BenchOptions& options);
std::vector<BenchRow> bench_auras(const BenchOptions& options);
std::vector<BenchRow> bench_handoff(const BenchOptions& options);
std::vector<BenchRow> bench_replicas(const BenchOptions& options);
std::vector<BenchRow> bench_wire(const BenchOptions& options);

}  // namespace aureole
