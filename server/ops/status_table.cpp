// JSON in, text out; see status_table.h.
#include "server/ops/status_table.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aureole {
namespace {

/// A name from another server, safe to print: control characters could steer the terminal.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
  return text;
}

ToleranceMark mark_from(const nlohmann::json& json) {
  ToleranceMark out;
  out.tolerance = printable(json.at("tolerance").get<std::string>());
  if (!json.at("peer").is_null()) out.peer = printable(json.at("peer").get<std::string>());
  out.since_tick = json.at("since_tick").get<std::int64_t>();
  out.value = json.at("value").get<double>();
  out.limit = json.at("limit").get<double>();
  out.unit = printable(json.at("unit").get<std::string>());
  return out;
}

RegionStatus region_from(const nlohmann::json& json) {
  RegionStatus out;
  out.name = printable(json.at("name").get<std::string>());
  out.up = json.at("up").get<bool>();
  out.recovering = json.value("recovering", false);
  out.bodies = json.at("bodies").get<std::int64_t>();
  out.awake = json.at("awake").get<std::int64_t>();
  out.frame_ms_p50 = json.at("frame_ms_p50").get<double>();
  out.frame_ms_max = json.at("frame_ms_max").get<double>();
  out.migrations_in = json.at("migrations_in").get<std::int64_t>();
  out.migrations_out = json.at("migrations_out").get<std::int64_t>();
  out.skipped_ticks = json.value("skipped_ticks", std::int64_t{0});
  out.missed_blows = json.value("missed_blows", std::int64_t{0});
  if (const auto outside = json.find("outside"); outside != json.end())
    for (const auto& mark : *outside) out.outside.push_back(mark_from(mark));
  return out;
}

bool is_down(const WorldStatus& status, const std::string& name) {
  return std::any_of(status.regions.begin(), status.regions.end(),
                     [&](const RegionStatus& r) { return !r.up && r.name == name; });
}

}  // namespace

Result<WorldStatus> parse_world_status(const std::string& json) {
  try {
    const auto parsed = nlohmann::json::parse(json);
    WorldStatus out;
    out.world_time_s = parsed.at("world_time_s").get<double>();
    out.bodies = parsed.at("bodies").get<std::int64_t>();
    out.players = parsed.at("players").get<std::int64_t>();
    for (const auto& region : parsed.at("regions")) out.regions.push_back(region_from(region));
    return out;
  } catch (const nlohmann::json::exception& wrong) {
    return Error::format("that is not the status of a world: {}", wrong.what());
  }
}

const RegionStatus* find_region(const WorldStatus& status, const std::string& name) {
  for (const auto& region : status.regions) {
    if (region.name == name) return &region;
  }
  for (std::size_t i = 0; i < status.regions.size(); ++i) {
    if (name == fmt::format("r{}", i)) return &status.regions[i];
  }
  return nullptr;
}

bool all_up(const WorldStatus& status) {
  return std::all_of(status.regions.begin(), status.regions.end(),
                     [](const RegionStatus& r) { return r.up && !r.recovering; });
}

std::string status_table(const WorldStatus& status) {
  std::string out = fmt::format("world time {:.1f} s, {} bodies, {} players\n", status.world_time_s,
                                status.bodies, status.players);
  std::size_t width = 6;
  for (const auto& r : status.regions) width = std::max(width, r.name.size());
  out += fmt::format("{:<{}}  {:<10}  {:>7}  {:>7}  {:>8}  {:>8}  {:>8}  {:>8}\n", "region", width,
                     "", "bodies", "awake", "p50 ms", "max ms", "came in", "went out");
  for (const auto& r : status.regions) {
    const char* state = !r.up ? "DOWN" : r.recovering ? "RECOVERING" : "up";
    out += fmt::format("{:<{}}  {:<10}  {:>7}  {:>7}  {:>8.2f}  {:>8.2f}  {:>8}  {:>8}\n", r.name,
                       width, state, r.bodies, r.awake, r.frame_ms_p50, r.frame_ms_max,
                       r.migrations_in, r.migrations_out);
  }
  for (const auto& r : status.regions)
    for (const auto& mark : r.outside) {
      // Its own line says it already, and once.
      if (is_down(status, mark.peer)) continue;
      const int digits = mark.unit.starts_with("ticks") ? 0 : 1;
      out += fmt::format(
          "! {} is outside its {} tolerance{} since tick {}: {:.{}f} {}, at most {:g}\n", r.name,
          mark.tolerance, mark.peer.empty() ? "" : " towards " + mark.peer, mark.since_tick,
          mark.value, digits, mark.unit, mark.limit);
    }
  for (const auto& r : status.regions)
    if (r.missed_blows > 0)
      out +=
          fmt::format("! {} has missed {} blows on other regions' resting bodies since its start\n",
                      r.name, r.missed_blows);
  return out;
}

}  // namespace aureole
