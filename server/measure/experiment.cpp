// Runs side by side, and once more for the oracles.
#include "server/measure/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "server/measure/judgement.h"
#include "server/measure/measured/bare_worlds.h"
#include "server/measure/measured/cold_caches.h"
#include "server/measure/measured/region_servers.h"
#include "server/measure/report.h"

namespace aureole {
namespace {

/// Ticks that one run takes before it is the next one's turn: long enough that caches hold what
/// they would hold if it ran alone.
constexpr std::int64_t turn_ticks = 16;

class Experiment {
 public:
  using Progress = std::function<void(const std::string&)>;
  Experiment(const ExperimentOptions& options, WorldDefinition world, const Progress& progress)
      : r_{options, std::move(world), BucketClock(options.workload.seconds), {}, {}, {}, {}, 0, {}},
        talks_(migration_mode_from(options.mode).has_value()),
        progress_(progress) {
    const ExperimentOptions& o = r_.options;
    r_.world.mode = migration_mode_from(o.mode).value_or(MigrationMode::adaptive);
    r_.modes = runs_of(o);
  }

  Status run() {
    const auto record = [&](const std::string& mode) {
      return RunRecord(mode == "single" ? 1 : r_.world.regions.size(), r_.options.workload.seconds,
                       r_.world.tolerances.frame_time_ms);
    };
    for (const std::string& mode : r_.modes) r_.runs.emplace(mode, record(mode));
    for (const std::string& mode : r_.modes)
      if (mode != r_.options.mode) r_.beside.emplace(mode, record(r_.options.mode));
    for (int repeat = 0; repeat < r_.options.repeats; ++repeat)
      if (auto measured = measure(repeat); !measured) return measured.error();
    if (!talks_ || !r_.options.judged) return Ok{};
    r_.judgement = judge(r_.world, server_options(), r_.clock, [&](Tick now) {
      if (now.value % turn_ticks == 0)
        progress_(fmt::format("oracles look at it: {:.0f} of {:.0f} s", now.seconds(),
                              r_.options.workload.seconds));
    });
    if (r_.judgement->state_hash != r_.hashes.at(r_.options.mode))
      return Error{"the run that the oracles looked at is not the one that was measured"};
    return Ok{};
  }

  nlohmann::json report() const { return report_of(r_); }

 private:
  RegionServers::Options server_options() const {
    const ExperimentOptions& o = r_.options;
    RegionServers::Options options;
    options.seed = o.workload.seed;
    options.network = {static_cast<Micros>(o.latency_ms * 1000),
                       static_cast<Micros>(o.jitter_ms * 1000), o.loss_pct / 100};
    options.clocks = cpu_clocks();
    options.follow_latency = o.follow_latency;
    return options;
  }

  std::function<void()> before_frame() {
    const double cold_s = r_.options.cold_caches_s;
    if (cold_s <= 0) return {};
    if (!cold_caches_) cold_caches_.emplace();
    return [this, from_s = r_.options.workload.seconds - cold_s] {
      if (now_.seconds() > from_s) cold_caches_->chill();
    };
  }

  std::unique_ptr<MeasuredRun> start(const std::string& mode) {
    if (mode == "cut")
      return std::make_unique<BareWorlds>(r_.world, BareWorlds::Crossing::handed_over, cpu_clocks(),
                                          before_frame());
    if (mode == "ideal")
      return std::make_unique<BareWorlds>(r_.world, BareWorlds::Crossing::stays, cpu_clocks(),
                                          before_frame());
    RegionServers::Options options = server_options();
    options.before_frame = before_frame();
    options.own_heaps = r_.options.cold_caches_s > 0;
    return std::make_unique<RegionServers>(mode == "single" ? in_one_region(r_.world) : r_.world,
                                           options);
  }

  /// Those that run in it; ours comes first.
  std::vector<std::string> modes_of(int repeat) const {
    const ExperimentOptions& o = r_.options;
    std::vector<std::string> modes{r_.modes.front()};
    if (repeat >= o.reference_repeats) return modes;
    std::copy_if(
        r_.modes.begin() + 1, r_.modes.end(), std::back_inserter(modes),
        [&](const std::string& mode) { return mode != "single" || repeat < o.single_repeats; });
    return modes;
  }

  Status measure(int repeat) {
    const std::vector<std::string> modes = modes_of(repeat);
    std::vector<std::unique_ptr<MeasuredRun>> runs;
    for (const std::string& mode : modes) {
      runs.push_back(start(mode));
      r_.runs.at(mode).begin_repeat();
      if (mode != r_.options.mode) r_.beside.at(mode).begin_repeat();
    }
    const Tick last = r_.clock.last();
    std::size_t turn = static_cast<std::size_t>(repeat);
    for (Tick from{1}; from <= last; from = from + turn_ticks, ++turn) {
      const Tick to = std::min(from + (turn_ticks - 1), last);
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const std::size_t which = (turn + i) % runs.size();
        for (Tick now = from; now <= to; now = now + 1) {
          now_ = now;
          runs[which]->tick();
          r_.runs.at(modes[which]).note(now, *runs[which]);
          if (which > 0) continue;
          for (std::size_t other = 1; other < modes.size(); ++other)
            r_.beside.at(modes[other]).note(now, *runs[which]);
        }
      }
      progress_(fmt::format("repeat {} of {}: {:.0f} of {:.0f} s", repeat + 1, r_.options.repeats,
                            to.seconds(), r_.options.workload.seconds));
    }
    std::uint64_t refused = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      refused += runs[i]->refused_messages();
      const std::uint64_t hash = runs[i]->state_hash();
      if (r_.hashes.try_emplace(modes[i], hash).first->second != hash)
        return Error::format("repeat {} of {} did not end like the first one", repeat + 1,
                             modes[i]);
    }
    r_.refused = std::max(r_.refused, refused);
    return Ok{};
  }

  ExperimentRecord r_;
  bool talks_;
  Tick now_;  ///< That is being measured.
  std::optional<ColdCaches> cold_caches_;
  const Progress& progress_;
};

}  // namespace

std::vector<std::string> runs_of(const ExperimentOptions& o) {
  std::vector<std::string> modes{o.mode};
  if (!migration_mode_from(o.mode) || !o.with_references) return modes;
  modes.insert(modes.end(), {"cut", "ideal"});
  const bool too_many = total_rate_per_s(o.workload) * o.workload.seconds > single_bodies_max;
  if (o.with_single && !too_many) modes.push_back("single");
  return modes;
}

Result<nlohmann::json> run_experiment(const ExperimentOptions& options,
                                      const std::function<void(const std::string&)>& progress) {
  auto world = workload_world(options.workload);
  if (!world) return world.error();
  Experiment experiment(options, std::move(*world), progress);
  if (auto ran = experiment.run(); !ran) return ran.error();
  return experiment.report();
}

}  // namespace aureole
