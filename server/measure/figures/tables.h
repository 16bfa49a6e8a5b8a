// What is demanded of the runs against what came, as a page of tables.
#pragma once

#include <string>
#include <vector>

#include "server/measure/figures/run_files.h"

namespace aureole {

enum class Verdict { unknown, passed, failed };

/// One demand.
struct BarResult {
  std::string bar;     ///< Of which run, and what of it.
  std::string wanted;  ///< "at least 0.90"
  std::string came;    ///< "0.87", or why nothing can be said.
  Verdict verdict = Verdict::unknown;
};

/// All demands in a fixed order, also those for which there are no runs.
std::vector<BarResult> bars_of(const std::vector<FinishedRun>& runs);

/// Markdown: the demands, then efficiency and parts of the frame run by run. `notes`, what was left
/// out of figures, come last.
std::string tables_of(const std::vector<FinishedRun>& runs, const std::vector<std::string>& notes);

}  // namespace aureole
