// The list of scenes, and their figures as a table and as JSON.
#include "server/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "server/base/check.h"

namespace aureole {
namespace {

constexpr std::array<BenchScene, 5> scenes{{
    {"physics", "Bullet's step: a heap that is poured, one that sleeps, bodies in flight.",
     bench_physics},
    {"auras",
     "Whole frames of two servers side by side, by their parts: physics; auras told, heard and\n"
     "projected; the summary of what is hosted and the policy's decisions; the wire.",
     bench_auras},
    {"handoff", "Groups of bodies leave one server and come to another, with their contacts.",
     bench_handoff},
    {"replicas", "What a server tells gateways of its bodies after each step.", bench_replicas},
    {"wire",
     "Messages of two servers read, checked and taken in: replicas by a gateway, auras and\n"
     "groups by the other server.",
     bench_wire},
}};

double per_body(const BenchRow& row) {
  return row.bodies > 0 ? row.cpu.median_us / row.bodies : 0;
}

}  // namespace

std::span<const BenchScene> bench_scenes() {
  return scenes;
}

const BenchScene* find_bench_scene(std::string_view name) {
  const auto* at = std::find_if(scenes.begin(), scenes.end(),
                                [&](const BenchScene& scene) { return scene.name == name; });
  return at == scenes.end() ? nullptr : at;
}

Spread spread_of(std::vector<double>& samples_us) {
  AUREOLE_CHECK(!samples_us.empty(), "something was measured");
  std::sort(samples_us.begin(), samples_us.end());
  const auto at = [&](double share) {
    return samples_us[static_cast<std::size_t>(share * static_cast<double>(samples_us.size() - 1))];
  };
  return {at(0.5), at(0.1), at(0.9)};
}

std::string table_of(std::span<const BenchRow> rows) {
  std::string table = fmt::format("{:<10} {:<30} {:>8} {:>8} {:>10} {:>9} {:>9} {:>9} {:>9}  {}\n",
                                  "situation", "operation", "bodies", "awake", "median µs", "p10",
                                  "p90", "µs/body", "bytes", "");
  for (const BenchRow& row : rows) {
    table += fmt::format(
        "{:<10} {:<30} {:>8.0f} {:>8.0f} {:>10.2f} {:>9.2f} {:>9.2f} {:>9.3f} {:>9}  {}\n",
        row.situation, row.operation, row.bodies, row.awake, row.cpu.median_us, row.cpu.p10_us,
        row.cpu.p90_us, per_body(row), row.bytes > 0 ? fmt::format("{:.0f}", row.bytes) : "–",
        row.note);
  }
  return table;
}

nlohmann::json json_of(const BenchScene& scene, const BenchOptions& options,
                       std::span<const BenchRow> rows) {
  nlohmann::json list = nlohmann::json::array();
  for (const BenchRow& row : rows)
    list.push_back({{"situation", row.situation},
                    {"operation", row.operation},
                    {"bodies", row.bodies},
                    {"awake", row.awake},
                    {"samples", row.samples},
                    {"cpu_us_median", row.cpu.median_us},
                    {"cpu_us_p10", row.cpu.p10_us},
                    {"cpu_us_p90", row.cpu.p90_us},
                    {"cpu_us_per_body", per_body(row)},
                    {"bytes", row.bytes},
                    {"note", row.note}});
  return {{"bench", scene.name},
          {"options",
           {{"bodies", options.bodies},
            {"seconds", options.seconds},
            {"ticks", options.ticks},
            {"repeats", options.repeats},
            {"seed", options.seed}}},
          {"results", list}};
}

}  // namespace aureole
