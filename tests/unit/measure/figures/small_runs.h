// Finished runs as they would lie on the disk, with numbers that a test can know.
#pragma once

#include "server/measure/figures/run_files.h"

namespace aureole {

/// Four buckets of 5 s. A server's frame is `t / servers` ms at t, 4 % of it besides physics, and
/// `cut` and `ideal` beside it are 0.95 and 0.85 of that; nothing is missed, lost or doubled.
FinishedRun small_run(Study study, const std::string& mode, int servers);

/// Columns and corners of every count that a demand is made of, and weak scaling, in both modes.
std::vector<FinishedRun> small_runs();

/// Of one mode; fails the test if there is none.
FinishedRun& run_among(std::vector<FinishedRun>& runs, Study study, const std::string& mode,
                       int servers);

}  // namespace aureole
