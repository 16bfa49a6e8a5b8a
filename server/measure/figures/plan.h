// Which runs of `aureole experiment` the figures and the studies are drawn from.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace aureole {

enum class Study {
  fig5,        ///< Fig. 5 of the paper: columns.
  fig7,        ///< Fig. 7 of the paper: corners.
  latency,     ///< Slow, uneven and lossy networks, with tolerances fixed and following.
  tolerances,  ///< Speed and latency tolerances other than the paper's.
  weak,        ///< More servers for more bodies.
  regions,     ///< Regions larger and smaller than those of the figures.
};
inline constexpr Study every_study[] = {Study::fig5,       Study::fig7, Study::latency,
                                        Study::tolerances, Study::weak, Study::regions};

/// "fig5" …: the word for --only, and the beginning of the names of its runs.
std::string_view word_of(Study study);
std::optional<Study> study_from(std::string_view word);

/// The network on which region servers talk in virtual time.
struct PlannedNetwork {
  double latency_ms = 2;  ///< Longest, one way.
  double jitter_ms = 1;   ///< It is this much less at most.
  double loss_pct = 0;    ///< Of packets; TCP shows them as stalls.
  bool operator==(const PlannedNetwork&) const = default;
};

/// The paper's, unless a study varies them.
struct PlannedTolerances {
  double speed_mps = 32;
  double latency_ms = 2;
  bool follow = false;  ///< They follow the latency that servers measure.
  bool operator==(const PlannedTolerances&) const = default;
};

/// One run: everything that its command line says.
struct PlannedRun {
  Study study = Study::fig5;
  std::string layout = "column";  ///< "column", "corner" or "grid".
  int servers = 1;
  std::string mode = "adaptive";
  double seconds = 60;
  double rate_per_s = 160;  ///< In weak scaling for every 4 servers.
  int repeats = 1;
  std::uint64_t seed = 1;
  double region_m = 150;  ///< Edge of a region.
  PlannedNetwork network;
  PlannedTolerances tolerances;
  bool judged = true;      ///< Whether oracles look at it once more.
  bool references = true;  ///< Whether `cut` and `ideal` run beside it.
  bool single = true;      ///< Whether `single` runs beside its first repeat, too.
  /// Frames of so many last seconds begin with cold caches.
  double cold_caches_s = 0;

  bool operator==(const PlannedRun&) const = default;
  /// Of its file, without the end; differs from that of every other run in the plan.
  std::string name() const;
  /// What follows `aureole`; --json is the runner's business.
  std::vector<std::string> arguments() const;
  /// About how long it takes, in units of its own: only the ratio of two runs means anything.
  double cost() const;
};

nlohmann::json to_json(const PlannedRun& run);
/// Errors: a field that is missing, of the wrong kind, or not as `aureole experiment` takes it, by
/// its name.
Result<PlannedRun> planned_run_from(const nlohmann::json& value);

struct PlanOptions {
  std::vector<Study> only;  ///< Empty: all.
  bool quick = false;       ///< About half an hour on two cores: fewer and shorter runs, once each.
  std::optional<double> seconds, rate_per_s;  ///< Instead of the plan's.
  std::optional<int> repeats;                 ///< The same, but for what runs once in any case.
  std::vector<int> servers;                   ///< Of the plan's numbers of servers; empty: all.
  std::uint64_t seed = 1;
};

/// In the order in which they run.
std::vector<PlannedRun> plan_of(const PlanOptions& options);

}  // namespace aureole
