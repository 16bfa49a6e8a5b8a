// JSON out, query strings in.
#include "server/gateway/web/api.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "server/gateway/web/static_files.h"

namespace aureole {
namespace {

using Json = nlohmann::json;

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// A decimal number and nothing else.
std::optional<double> number(const std::string& text) {
  const bool plain = !text.empty() && text.size() < 32 &&
                     text.find_first_not_of("0123456789.eE+-") == std::string::npos;
  if (!plain) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end != text.c_str() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

Json json_of(const ToleranceEvent& mark, const WorldDefinition& world) {
  using Kind = ToleranceEvent::Kind;
  const bool of_a_link = mark.kind == Kind::latency || mark.kind == Kind::link;
  Json peer = nullptr;
  if (of_a_link) peer = world.regions.at(mark.peer.value).name;
  return {{"tolerance", name_of(mark.kind)},
          {"peer", std::move(peer)},
          {"since_tick", mark.tick.value},
          {"value", mark.value},
          {"limit", mark.limit},
          {"unit", mark.kind == Kind::speed  ? "m/s"
                   : mark.kind == Kind::link ? "ticks without word"
                                             : "ms"}};
}

Json json_of(const RegionReport& report, const std::string& name, const WorldDefinition& world) {
  Json outside = Json::array();
  for (const ToleranceEvent& mark : report.outside) outside.push_back(json_of(mark, world));
  return {{"name", name},
          {"up", report.up},
          {"bodies", report.bodies},
          {"awake", report.awake},
          {"frame_ms_p50", report.frame_ms_p50},
          {"frame_ms_max", report.frame_ms_max},
          {"migrations_in", report.migrations_in},
          {"migrations_out", report.migrations_out},
          {"overruns", report.overruns},
          {"skipped_ticks", report.skipped_ticks},
          {"removed_strays", report.removed_strays},
          {"unacknowledged", report.unacknowledged},
          {"outside", std::move(outside)},
          {"tolerance_events", report.tolerance_events},
          {"missed_blows", report.missed_blows},
          {"whole_looks", report.whole_looks},
          {"recovering", report.recovering}};
}

Json json_of(const PlayerReport& report) {
  return {{"name", report.name},
          {"region", report.region},
          {"fps", report.fps},
          {"quality", report.quality},
          {"scale", report.scale},
          {"width", report.width},
          {"height", report.height},
          {"round_trip_ms", report.round_trip_ms},
          {"unapplied", report.unapplied}};
}

}  // namespace

std::string status_json(const WorldDefinition& world, const RegionSubscriber& regions,
                        const std::vector<PlayerReport>& players, const PictureRates& pictures,
                        std::optional<std::int64_t> world_us) {
  Json region_list = Json::array(), player_list = Json::array();
  for (std::size_t r = 0; r < world.regions.size(); ++r)
    region_list.push_back(json_of(regions.reports()[r], world.regions[r].name, world));
  for (const PlayerReport& player : players) player_list.push_back(json_of(player));
  Json time = nullptr;
  if (world_us) time = static_cast<double>(*world_us) / 1e6;
  return dumped({{"world", world.name},
                 {"world_time_s", std::move(time)},
                 {"bodies", regions.store().size()},
                 {"awake", regions.store().awake_count()},
                 {"players", players.size()},
                 {"complete", regions.all_complete()},
                 {"regions", std::move(region_list)},
                 {"player_list", std::move(player_list)},
                 {"pictures",
                  {{"per_s", pictures.per_s},
                   {"render_ms", pictures.render_ms},
                   {"encode_ms", pictures.encode_ms},
                   {"bytes", pictures.bytes}}}});
}

std::string replicas_json(const WorldDefinition& world, const Moment& moment) {
  Json bodies = Json::array();
  for (const ReplicaPose& pose : moment.poses) {
    const auto& p = pose.position;
    const auto& q = pose.orientation;
    bodies.push_back({{"id", std::to_string(pose.id.value)},
                      {"owner", world.regions.at(pose.owner.value).name},
                      {"prototype", world.prototypes.at(pose.prototype.value).name},
                      {"asleep", pose.asleep},
                      {"position", {p.x, p.y, p.z}},
                      {"orientation", {q.x(), q.y(), q.z(), q.w()}}});
  }
  return dumped({{"world_time_s", static_cast<double>(moment.world_us) / 1e6},
                 {"bodies", std::move(bodies)}});
}

Result<FrameQuery> parse_frame_query(std::string_view query) {
  FrameQuery out;
  unsigned seen = 0;
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string key(pair.substr(0, equals));
    const auto value = percent_decoded(pair.substr(std::min(equals + 1, pair.size())));
    if (key.size() > 16 || !value) return Error{"A field of the query cannot be read"};
    if (key == "format") {
      if (*value != "jpg" && *value != "ppm") return Error{"\"format\" must be jpg or ppm"};
      out.format = *value == "ppm" ? PictureFormat::ppm : PictureFormat::jpeg;
      continue;
    }
    struct Range {
      double min, max;
      bool whole;
    };
    const bool is_place = key == "x" || key == "y" || key == "z";
    const Range range = is_place                               ? Range{-8192, 8192, false}
                        : key == "yaw"                         ? Range{-7, 7, false}
                        : key == "pitch"                       ? Range{-1.6, 1.6, false}
                        : key == "w"                           ? Range{16, max_picture_width, true}
                        : key == "h"                           ? Range{16, max_picture_height, true}
                        : key == "quality"                     ? Range{1, 100, true}
                        : key == "tint" || key == "boundaries" ? Range{0, 1, true}
                                                               : Range{1, 0, false};
    if (range.min > range.max) return Error{"A field of the query is unknown"};
    const auto n = number(*value);
    if (!n || *n < range.min || *n > range.max || (range.whole && *n != std::floor(*n)))
      return Error::format("\"{}\" must be a {}number from {} to {}", key,
                           range.whole ? "whole " : "", range.min, range.max);
    auto& camera = out.view.camera;
    if (key == "x") camera.eye.x() = static_cast<float>(*n), seen |= 1;
    if (key == "y") camera.eye.y() = static_cast<float>(*n), seen |= 2;
    if (key == "z") camera.eye.z() = static_cast<float>(*n), seen |= 4;
    if (key == "yaw") camera.yaw_rad = static_cast<float>(*n);
    if (key == "pitch") camera.pitch_rad = static_cast<float>(*n);
    if (key == "w") out.view.width = static_cast<int>(*n);
    if (key == "h") out.view.height = static_cast<int>(*n);
    if (key == "quality") out.quality = static_cast<int>(*n);
    if (key == "tint") out.tinted = *n != 0;
    if (key == "boundaries") out.view.show_boundaries = *n != 0;
  }
  if (seen != 7) return Error{"\"x\", \"y\" and \"z\" must be given"};
  return out;
}

}  // namespace aureole
