// The paper's experiments (section 5): one layout, one mode, and the limits it is measured against.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/measure/workload/workload.h"

namespace aureole {

struct ExperimentOptions {
  WorkloadOptions workload;
  /// "naive", "paper", "adaptive": region servers that talk. "single": one server for everything.
  /// "ideal": worlds that do not talk. "cut": worlds that hand bodies over at no cost.
  std::string mode = "adaptive";
  int repeats = 1;
  double latency_ms = 2;  ///< Longest, one way.
  double jitter_ms = 1;   ///< It is this much less at most.
  double loss_pct = 0;    ///< Of TCP segments; see PacketLoss.
  /// The latency tolerance follows what links measure (FollowedLatency).
  bool follow_latency = false;
  /// So long before the end every frame begins with cold caches (ColdCaches); servers have heaps of
  /// their own then (ServerThread). For the comparison of many servers with few.
  double cold_caches_s = 0;
  /// Whether modes of servers that talk are also run as `cut` and `ideal`.
  bool with_references = true;
  /// In how many of the repeats, at most; they are compared with the same repeats of ours.
  int reference_repeats = 1000;
  /// The same for `single` alone, which takes longer than all others together.
  int single_repeats = 1000;
  /// Whether they are also run as `single`, for the speedup; not if there are more bodies than
  /// `single_bodies_max`.
  bool with_single = true;
  /// Whether the run is taken once more for the oracles to look at.
  bool judged = true;
};

/// One server for more would take longer than anybody waits, and be of no use to compare with.
inline constexpr double single_bodies_max = 20'000;

/// The mode asked for, then those that run beside it.
std::vector<std::string> runs_of(const ExperimentOptions& options);

/// Runs the experiment in this thread. `progress` hears a sentence now and then. The repeats of a
/// run differ in their times only.
///
/// A mode of servers that talk runs side by side with `single`, `cut` and `ideal`, each a quarter
/// of a second at a time, in an order that changes: what slows the machine down slows all of them
/// down. Errors: a layout that does not exist; a run that did not repeat itself (a defect).
Result<nlohmann::json> run_experiment(const ExperimentOptions& options,
                                      const std::function<void(const std::string&)>& progress);

}  // namespace aureole
