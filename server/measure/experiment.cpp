// Runs side by side, ratios between them, and the report.
#include "server/measure/experiment.h"

#include <fmt/format.h>

#include <map>
#include <optional>

#include "server/measure/bare_worlds.h"
#include "server/measure/judgement.h"
#include "server/measure/region_servers.h"
#include "server/worlds/injector.h"

namespace aureole {
namespace {

/// Ticks that one run takes before it is the next one's turn: long enough that caches hold what
/// they would hold if it ran alone.
constexpr std::int64_t turn_ticks = 16;

class Experiment {
 public:
  using Progress = std::function<void(const std::string&)>;
  Experiment(const ExperimentOptions& options, WorldDefinition world, const Progress& progress)
      : o_(options),
        world_(std::move(world)),
        talks_(migration_mode_from(o_.mode).has_value()),
        clock_(o_.workload.seconds),
        progress_(progress) {
    world_.mode = migration_mode_from(o_.mode).value_or(MigrationMode::adaptive);
    modes_.push_back(o_.mode);
    if (!talks_) return;
    modes_.insert(modes_.end(), {"cut", "ideal"});
    if (o_.with_single) modes_.push_back("single");
  }

  Status run() {
    for (const std::string& mode : modes_)
      records_.emplace(
          mode, RunRecord(mode == "single" ? 1 : world_.regions.size(), o_.workload.seconds));
    for (int repeat = 0; repeat < o_.repeats; ++repeat)
      if (auto measured = measure(repeat); !measured) return measured.error();
    if (!talks_) return Ok{};
    judgement_ = judge(world_, server_options(), clock_, [&](Tick now) {
      if (now.value % turn_ticks == 0)
        progress_(fmt::format("oracles look at it: {:.0f} of {:.0f} s", now.seconds(),
                              o_.workload.seconds));
    });
    if (judgement_->state_hash != hashes_.at(o_.mode))
      return Error{"the run that the oracles looked at is not the one that was measured"};
    return Ok{};
  }

  nlohmann::json report() const {
    nlohmann::json buckets = nlohmann::json::array(), references = nlohmann::json::object();
    for (std::size_t b = 0; b < clock_.count(); ++b) {
      nlohmann::json bucket = record(o_.mode).to_json(b);
      bucket["missed_interactions"] = nullptr;
      bucket["missed_interactions_in_tolerance"] = nullptr;
      if (judgement_) {
        bucket["missed_interactions"] = judgement_->missed[b];
        bucket["missed_interactions_in_tolerance"] = judgement_->missed_in_tolerance[b];
      }
      bucket.update(ratios(b, b + 1));
      buckets.push_back(std::move(bucket));
    }
    for (const std::string& mode : modes_) {
      if (mode == o_.mode) continue;
      for (std::size_t b = 0; b < clock_.count(); ++b)
        references[mode]["buckets"].push_back(record(mode).to_json(b));
    }
    nlohmann::json all = {{"experiment", description()},
                          {"buckets", std::move(buckets)},
                          {"references", std::move(references)},
                          {"last_10_s", last_10_s()},
                          {"state_hash", fmt::format("{:016x}", hashes_.at(o_.mode))},
                          {"refused_messages", refused_},
                          {"bodies_injected", injected()},
                          {"bodies_lost", nullptr},
                          {"bodies_duplicated", nullptr},
                          {"violations", nlohmann::json::array()}};
    if (judgement_) {
      all["bodies_lost"] = judgement_->bodies_lost;
      all["bodies_duplicated"] = judgement_->bodies_duplicated;
      all["violations"] = judgement_->violations;
    }
    return all;
  }

 private:
  RegionServers::Options server_options() const {
    return {o_.workload.seed,
            {static_cast<Micros>(o_.latency_ms * 1000), static_cast<Micros>(o_.jitter_ms * 1000)},
            &thread_cpu_ns,
            false};
  }

  std::unique_ptr<MeasuredRun> start(const std::string& mode) const {
    if (mode == "cut")
      return std::make_unique<BareWorlds>(world_, BareWorlds::Crossing::handed_over,
                                          &thread_cpu_ns);
    if (mode == "ideal")
      return std::make_unique<BareWorlds>(world_, BareWorlds::Crossing::stays, &thread_cpu_ns);
    return std::make_unique<RegionServers>(mode == "single" ? in_one_region(world_) : world_,
                                           server_options());
  }

  Status measure(int repeat) {
    std::vector<std::unique_ptr<MeasuredRun>> runs;
    for (const std::string& mode : modes_) {
      runs.push_back(start(mode));
      records_.at(mode).begin_repeat();
    }
    std::size_t turn = static_cast<std::size_t>(repeat);
    for (Tick from{1}; from <= clock_.last(); from = from + turn_ticks, ++turn) {
      const Tick to = std::min(from + (turn_ticks - 1), clock_.last());
      for (std::size_t i = 0; i < runs.size(); ++i) {
        const std::size_t which = (turn + i) % runs.size();
        for (Tick now = from; now <= to; now = now + 1) {
          runs[which]->tick();
          records_.at(modes_[which]).note(now, *runs[which]);
        }
      }
      progress_(fmt::format("repeat {} of {}: {:.0f} of {:.0f} s", repeat + 1, o_.repeats,
                            to.seconds(), o_.workload.seconds));
    }
    refused_ = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      refused_ += runs[i]->refused_messages();
      const std::uint64_t hash = runs[i]->state_hash();
      if (hashes_.try_emplace(modes_[i], hash).first->second != hash)
        return Error::format("repeat {} of {} did not end like the first one", repeat + 1,
                             modes_[i]);
    }
    return Ok{};
  }

  const RunRecord& record(const std::string& mode) const { return records_.at(mode); }

  /// Theirs over ours, by the busiest server's mean frame.
  nlohmann::json ratio(const std::string& reference, std::size_t first, std::size_t end) const {
    const auto found = records_.find(reference);
    const double ours = total_ms(record(o_.mode).worst_server(first, end));
    if (!talks_ || found == records_.end() || ours <= 0) return nullptr;
    return total_ms(found->second.worst_server(first, end)) / ours;
  }

  nlohmann::json ratios(std::size_t first, std::size_t end) const {
    return {{"speedup", ratio("single", first, end)},
            {"efficiency", ratio("cut", first, end)},
            {"efficiency_ideal", ratio("ideal", first, end)}};
  }

  nlohmann::json last_10_s() const {
    const std::size_t end = clock_.count(), first = end - std::min<std::size_t>(end, 2);
    nlohmann::json last = ratios(first, end);
    const FrameTime worst = record(o_.mode).worst_server(first, end);
    last["worst_server_ms"] = total_ms(worst);
    last["share_besides_physics"] =
        1 - worst[static_cast<std::size_t>(StepProfile::Part::physics)] / total_ms(worst);
    for (const std::string& mode : modes_)
      last["reference_ms"][mode] = total_ms(record(mode).worst_server(first, end));
    return last;
  }

  nlohmann::json description() const {
    return {{"layout", o_.workload.layout},
            {"servers", o_.workload.servers},
            {"mode", o_.mode},
            {"seconds", o_.workload.seconds},
            {"rate_per_s", o_.workload.rate_per_s},
            {"seed", o_.workload.seed},
            {"repeats", o_.repeats},
            {"latency_ms", o_.latency_ms},
            {"jitter_ms", o_.jitter_ms},
            {"region_m", workload_region_m},
            {"step_ms", tick_us / 1e3},
            {"tolerances",
             {{"speed_mps", world_.tolerances.speed_mps},
              {"latency_ms", world_.tolerances.latency_ms},
              {"frame_time_ms", world_.tolerances.frame_time_ms}}}};
  }

  std::uint64_t injected() const {
    std::uint64_t sum = 0;
    for (const Injector& injector : world_.injectors)
      sum += injected_count(injector, clock_.last());
    return sum;
  }

  const ExperimentOptions& o_;
  WorldDefinition world_;
  bool talks_;
  BucketClock clock_;
  const Progress& progress_;
  std::vector<std::string> modes_;  ///< The one asked for first.
  std::map<std::string, RunRecord> records_;
  std::map<std::string, std::uint64_t> hashes_;
  std::uint64_t refused_ = 0;
  std::optional<Judgement> judgement_;
};

}  // namespace

Result<nlohmann::json> run_experiment(const ExperimentOptions& options,
                                      const std::function<void(const std::string&)>& progress) {
  auto world = workload_world(options.workload);
  if (!world) return world.error();
  Experiment experiment(options, std::move(*world), progress);
  if (auto ran = experiment.run(); !ran) return ran.error();
  return experiment.report();
}

}  // namespace aureole
