// What a seed's run came to: the numbers of the report, and the first broken rule in words.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/experiment/step_trail.h"

namespace aureole {

/// One broken rule: enough to look at the right tick of a replay.
struct Violation {
  std::string rule;  ///< "duplicated", "lost", "missed", "thrash", "unsettled", "refused", …
  std::int64_t tick = 0;
  std::string what;  ///< Bodies and servers, as a sentence.
};

struct SeedResult {
  std::uint64_t seed = 0;
  std::string scenario;
  std::uint64_t ticks = 0;
  std::uint64_t bodies_spawned = 0;      ///< That were ever hosted anywhere.
  std::uint64_t bodies_lost = 0;         ///< That ought to be in the world and are not.
  std::uint64_t bodies_duplicated = 0;   ///< Simulated by two servers, or back after removal.
  std::uint64_t bodies_rolled_back = 0;  ///< Born in the last 100 ms before a crash; not lost.
  std::uint64_t missed_interactions = 0;
  std::uint64_t missed_interactions_in_tolerance = 0;
  std::uint64_t missed_at_birth = 0;   ///< Left out of the two above; see oracle_interactions.h.
  std::uint64_t struck_stand_ins = 0;  ///< Part of the two above.
  std::uint64_t stand_ins_max = 0;
  std::uint64_t tolerance_events = 0;
  std::uint64_t migrations = 0;
  std::uint64_t migrations_per_body_max_per_s = 0;
  std::uint64_t forced_changes = 0;  ///< Third ones in a second that could not be helped.
  std::uint64_t unsettled = 0;     ///< At the end: asleep away from home, or still changing owner.
  std::uint64_t awake_at_end = 0;  ///< After all the calm that was given.
  std::uint64_t rest_not_judged = 0;  ///< Asleep, but beside what was still awake.
  std::uint64_t refused_messages = 0;
  std::uint64_t version_conflicts = 0;
  double foreign_hosted_share_max = 0;    ///< By the lines in force (home_lines.h).
  std::uint64_t largest_cluster = 0;      ///< Bodies in one handoff.
  std::vector<double> handoff_jumps_mm;   ///< Samples.
  std::uint64_t crashes = 0, resets = 0;  ///< Faults that happened.
  std::uint64_t hash = 0;                 ///< Of all cores at all steps.
  std::vector<StepMark> trail;            ///< Of all steps, if the run was to keep it.
  double cpu_s = 0;
  double cpu_physics_share = 0;
  std::vector<Violation> violations;  ///< The first few of each rule.

  bool all_rules_held() const { return violations.empty(); }
};

nlohmann::json to_json(const SeedResult& result);
Result<SeedResult> seed_result_from(const nlohmann::json& json);

/// Totals over seeds, as the report has them.
struct RunTotals {
  void add(const SeedResult& result);
  nlohmann::json to_json() const;

  std::uint64_t seeds = 0, failed_seeds = 0, hash_mismatches = 0, ended_early = 0;
  std::uint64_t compared = 0, compared_failed = 0;  ///< Against one server.
  SeedResult sum;                                   ///< Sums, and maxima where the name says so.
};

}  // namespace aureole
