// What an experiment has measured and judged, and the JSON that is made of it.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/measure/experiment.h"
#include "server/measure/judgement.h"
#include "server/measure/run_record.h"
#include "server/worlds/world.h"

namespace aureole {

struct ExperimentRecord {
  ExperimentOptions options;
  WorldDefinition world;
  BucketClock clock;
  std::vector<std::string> modes;  ///< The one asked for first, then those that ran beside it.
  std::map<std::string, RunRecord> runs;
  /// Ours, of the repeats that each of the others ran beside only; by that one's name.
  std::map<std::string, RunRecord> beside;
  std::map<std::string, std::uint64_t> hashes;
  std::uint64_t refused = 0;
  std::optional<Judgement> judgement;

  /// Of all repeats.
  const RunRecord& own() const { return runs.at(options.mode); }
};

/// docs/experiment-command.md says what is in it.
nlohmann::json report_of(const ExperimentRecord& record);

}  // namespace aureole
