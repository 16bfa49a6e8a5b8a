// The files in which finished runs lie: whole or not there.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/measure/figures/plan.h"

namespace aureole {

/// A run and what `aureole experiment` reported of it.
struct FinishedRun {
  PlannedRun plan;
  std::vector<std::string> arguments;  ///< With which it was made.
  std::string build;                   ///< Which made it; see build_version().
  nlohmann::json report;
};

/// Changes whenever the executable does. Errors: it cannot be read.
Result<std::string> build_version(const std::filesystem::path& executable);

/// DIR/runs/NAME.json
std::filesystem::path run_file(const std::filesystem::path& out, const PlannedRun& run);

/// Reads a report as the child has written it. Errors: not there, too large (256 MiB), not JSON,
/// not the report of an experiment that came to its end, or with a number beyond ±1e15 in it (seeds
/// aside): nothing that is measured is so large, and nothing could be drawn beside it.
Result<nlohmann::json> read_report(const std::filesystem::path& file);

/// A run that was finished. Errors: those of read_report(), and a file that does not say how it was
/// made, or says what `aureole experiment` does not take.
Result<FinishedRun> read_run(const std::filesystem::path& file);

/// Under a name of its own first, renamed when it is whole. Errors: it cannot be written.
Status write_run(const std::filesystem::path& file, const FinishedRun& run);
Status write_whole(const std::filesystem::path& file, const std::string& text);

/// Those of the studies wanted (all if empty) that lie in DIR/runs, sorted by study, servers and
/// name. What cannot be read becomes a sentence in `notes`.
std::vector<FinishedRun> read_runs(const std::filesystem::path& out, const std::vector<Study>& only,
                                   std::vector<std::string>& notes);

}  // namespace aureole
