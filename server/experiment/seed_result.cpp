// Results as JSON, and their totals.
#include "server/experiment/seed_result.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aureole {
namespace {

/// Calls `use(name, member)` for every plain number of a result, in the report's order.
template <class Result, class Use>
void for_each_number(Result& r, Use use) {
  use("ticks", r.ticks);
  use("bodies_spawned", r.bodies_spawned);
  use("bodies_lost", r.bodies_lost);
  use("bodies_duplicated", r.bodies_duplicated);
  use("bodies_rolled_back", r.bodies_rolled_back);
  use("missed_interactions", r.missed_interactions);
  use("missed_interactions_in_tolerance", r.missed_interactions_in_tolerance);
  use("missed_at_birth", r.missed_at_birth);
  use("struck_stand_ins", r.struck_stand_ins);
  use("stand_ins_max", r.stand_ins_max);
  use("tolerance_events", r.tolerance_events);
  use("migrations", r.migrations);
  use("migrations_per_body_max_per_s", r.migrations_per_body_max_per_s);
  use("forced_changes", r.forced_changes);
  use("unsettled", r.unsettled);
  use("awake_at_end", r.awake_at_end);
  use("rest_not_judged", r.rest_not_judged);
  use("refused_messages", r.refused_messages);
  use("version_conflicts", r.version_conflicts);
  use("foreign_hosted_share_max", r.foreign_hosted_share_max);
  use("largest_cluster", r.largest_cluster);
  use("crashes", r.crashes);
  use("resets", r.resets);
  use("cpu_s", r.cpu_s);
}

bool is_maximum(std::string_view name) {
  return name.ends_with("_max") || name.ends_with("_max_per_s") || name == "largest_cluster";
}

}  // namespace

nlohmann::json to_json(const SeedResult& result) {
  nlohmann::json json{{"seed", result.seed}, {"scenario", result.scenario}};
  for_each_number(result, [&](const char* name, const auto& value) { json[name] = value; });
  json["handoff_jumps_mm"] = result.handoff_jumps_mm;
  json["hash"] = result.hash;
  nlohmann::json trail = nlohmann::json::array();
  for (const StepMark& m : result.trail) trail.push_back({m.tick, m.server, m.bodies, m.hash});
  json["trail"] = trail;
  nlohmann::json list = nlohmann::json::array();
  for (const Violation& v : result.violations)
    list.push_back({{"rule", v.rule}, {"tick", v.tick}, {"what", v.what}});
  json["violations"] = list;
  return json;
}

Result<SeedResult> seed_result_from(const nlohmann::json& json) {
  SeedResult result;
  try {
    json.at("seed").get_to(result.seed);
    json.at("scenario").get_to(result.scenario);
    for_each_number(result, [&](const char* name, auto& value) { json.at(name).get_to(value); });
    json.at("handoff_jumps_mm").get_to(result.handoff_jumps_mm);
    json.at("hash").get_to(result.hash);
    for (const auto& m : json.at("trail"))
      result.trail.push_back({m.at(0), m.at(1), m.at(2), m.at(3)});
    for (const auto& v : json.at("violations"))
      result.violations.push_back({v.at("rule"), v.at("tick"), v.at("what")});
  } catch (const nlohmann::json::exception& wrong) {
    return Error::format("a seed's result cannot be read: {}", wrong.what());
  }
  return result;
}

void RunTotals::add(const SeedResult& result) {
  ++seeds;
  if (!result.all_rules_held()) ++failed_seeds;
  std::vector<double> values;
  for_each_number(result, [&](const char*, const auto& value) {
    values.push_back(static_cast<double>(value));
  });
  std::size_t next = 0;
  for_each_number(sum, [&]<class T>(const char* name, T& total) {
    const T value = static_cast<T>(values[next++]);
    total = is_maximum(name) ? std::max(total, value) : total + value;
  });
  sum.handoff_jumps_mm.insert(sum.handoff_jumps_mm.end(), result.handoff_jumps_mm.begin(),
                              result.handoff_jumps_mm.end());
}

nlohmann::json RunTotals::to_json() const {
  nlohmann::json json{{"seeds", seeds},
                      {"failed_seeds", failed_seeds},
                      {"ended_early", ended_early},
                      {"hash_mismatches", hash_mismatches},
                      {"compared_with_one_server", compared},
                      {"compared_with_one_server_failed", compared_failed}};
  for_each_number(sum, [&](const char* name, const auto& value) { json[name] = value; });
  std::vector<double> jumps = sum.handoff_jumps_mm;
  std::sort(jumps.begin(), jumps.end());
  const auto at = [&](double share) {
    return jumps.empty() ? 0 : jumps[static_cast<std::size_t>(share * (jumps.size() - 1.0))];
  };
  json["handoff_jump_samples"] = jumps.size();
  json["handoff_jump_mm_p50"] = at(0.5);
  json["handoff_jump_mm_p99"] = at(0.99);
  json["handoff_jump_mm_max"] = at(1);
  return json;
}

}  // namespace aureole
