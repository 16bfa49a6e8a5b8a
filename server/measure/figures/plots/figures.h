// What is drawn from finished runs.
#pragma once

#include <string>
#include <vector>

#include "server/measure/figures/plots/gnuplot.h"
#include "server/measure/figures/plots/panels.h"
#include "server/measure/figures/run_files.h"

namespace aureole {

/// Those of one study that were made alike.
struct StudyRuns {
  std::vector<const FinishedRun*> runs;
  std::string setting;  ///< "60 s at 160 bodies/s, mean of 5 repeats"

  /// The one for so many servers, if there is one.
  const FinishedRun* find(const std::string& mode, int servers) const;
  /// Of the runs of one mode, in rising order.
  std::vector<int> server_counts(const std::string& mode) const;
};

/// Whether a run belongs to a study: it was made for it, or it is one of a single server, which is
/// the same run for columns and corners, and may have been made for either.
bool is_of(Study study, const PlannedRun& run);

/// A figure has the same workload in all of its runs: those that differ from most in seconds, rate
/// or seed, or from most of their mode in repeats, are left out, with a sentence in `notes`.
StudyRuns runs_of(Study study, const std::vector<FinishedRun>& runs,
                  std::vector<std::string>& notes);

/// All that the runs have data for; what is left out, and why, becomes a sentence in `notes`.
std::vector<Figure> figures_of(const std::vector<FinishedRun>& runs,
                               std::vector<std::string>& notes);

/// fig5 or fig7: the longest frame of any server by bucket, a curve for each number of servers.
void add_frame_time_figure(Study study, const StudyRuns& runs, std::vector<Figure>& figures);
/// Hosted bodies of every server over time.
void add_hosted_figure(const StudyRuns& columns, std::vector<Figure>& figures);
/// `cut` / ours and `ideal` / ours by number of servers.
void add_efficiency_figure(const StudyRuns& columns, const StudyRuns& corners,
                           std::vector<Figure>& figures, std::vector<std::string>& notes);
/// Where the busiest server's frame goes.
void add_split_figure(Study study, const StudyRuns& runs, std::vector<Figure>& figures,
                      std::vector<std::string>& notes);
void add_latency_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                        std::vector<std::string>& notes);
void add_tolerances_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                           std::vector<std::string>& notes);
void add_weak_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                     std::vector<std::string>& notes);
/// `cut` / ours and `ideal` / ours by the edge of a region.
void add_regions_figure(const StudyRuns& runs, std::vector<Figure>& figures,
                        std::vector<std::string>& notes);

Figure figure_of(std::string name, const Sheet& sheet);

/// Blue for `adaptive`, vermilion for `paper`.
std::string colour_of(const std::string& mode);
/// A circle for `adaptive`, a square for `paper`.
PointMark mark_of(const std::string& mode);
/// "1 server", "4 servers".
std::string servers_in_words(int servers);

}  // namespace aureole
