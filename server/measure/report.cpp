// Buckets, totals, and ratios between runs.
#include "server/measure/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/worlds/injector.h"

namespace aureole {
namespace {

using nlohmann::json;

json in_json(const HandoffJumps& jumps) {
  json all = {{"samples", jumps.samples}, {"p99", nullptr}, {"max", nullptr}};
  if (jumps.samples == 0) return all;
  all["p99"] = jumps.p99_mm;
  all["max"] = jumps.max_mm;
  return all;
}

class Report {
 public:
  explicit Report(const ExperimentRecord& record) : r_(record), end_(record.clock.count()) {}

  json make() const {
    json buckets = json::array(), references = json::object();
    for (std::size_t b = 0; b < end_; ++b) {
      json bucket = r_.own().to_json(b);
      bucket.update(judged(b));
      bucket.update(ratios(b, b + 1));
      buckets.push_back(std::move(bucket));
    }
    for (const std::string& mode : r_.modes) {
      if (mode == r_.options.mode) continue;
      for (std::size_t b = 0; b < end_; ++b)
        references[mode]["buckets"].push_back(r_.runs.at(mode).to_json(b));
    }
    json all = {{"experiment", description()},
                {"buckets", std::move(buckets)},
                {"references", std::move(references)},
                {"last_10_s", last_10_s()},
                {"total", total()},
                {"state_hash", fmt::format("{:016x}", r_.hashes.at(r_.options.mode))},
                {"refused_messages", r_.refused},
                {"bodies_injected", injected()},
                {"bodies_lost", nullptr},
                {"bodies_duplicated", nullptr},
                {"violations", json::array()}};
    if (r_.judgement) {
      all["bodies_lost"] = r_.judgement->bodies_lost;
      all["bodies_duplicated"] = r_.judgement->bodies_duplicated;
      all["violations"] = r_.judgement->violations;
    }
    return all;
  }

 private:
  static json judged(const json& missed, const json& in_tolerance, const json& jumps,
                     const json& wire) {
    return {{"missed_interactions", missed},
            {"missed_interactions_in_tolerance", in_tolerance},
            {"handoff_jump_mm", jumps},
            {"wire", wire}};
  }

  json judged(std::size_t b) const {
    if (!r_.judgement) return judged(nullptr, nullptr, nullptr, nullptr);
    const Judgement& j = *r_.judgement;
    return judged(j.missed[b], j.missed_in_tolerance[b], in_json(j.jumps[b]), to_json(j.wire[b]));
  }

  json total() const {
    json all = r_.own().tolerances(0, end_);
    std::uint64_t migrations = 0;
    for (std::size_t b = 0; b < end_; ++b)
      migrations += r_.own().to_json(b)["migrations"].get<std::uint64_t>();
    all["migrations"] = migrations;
    if (!r_.judgement) {
      all.update(judged(nullptr, nullptr, nullptr, nullptr));
      return all;
    }
    const Judgement& j = *r_.judgement;
    const auto sum = [](const std::vector<std::uint64_t>& counts) {
      std::uint64_t all_of_them = 0;
      for (const std::uint64_t count : counts) all_of_them += count;
      return all_of_them;
    };
    all.update(judged(sum(j.missed), sum(j.missed_in_tolerance), in_json(j.all_jumps),
                      to_json(j.all_wire)));
    return all;
  }

  /// Theirs over ours, by the busiest server's mean frame.
  json ratio(const std::string& reference, std::size_t first, std::size_t end) const {
    const auto found = r_.runs.find(reference);
    if (reference == r_.options.mode || found == r_.runs.end()) return nullptr;
    const double ours = total_ms(r_.beside.at(reference).worst_server(first, end));
    if (ours <= 0) return nullptr;
    return total_ms(found->second.worst_server(first, end)) / ours;
  }

  json ratios(std::size_t first, std::size_t end) const {
    return {{"speedup", ratio("single", first, end)},
            {"efficiency", ratio("cut", first, end)},
            {"efficiency_ideal", ratio("ideal", first, end)}};
  }

  /// Of the repeats that `cut` and `ideal` ran beside.
  const RunRecord& own_beside_references() const {
    const auto found = r_.beside.find("cut");
    return found == r_.beside.end() ? r_.own() : found->second;
  }

  json last_10_s() const {
    const std::size_t first = end_ - std::min<std::size_t>(end_, 2);
    json last = ratios(first, end_);
    const FrameTime worst = r_.own().worst_server(first, end_);
    last["worst_server_ms"] = total_ms(worst);
    last["median_server_ms"] = r_.own().median_server_ms(first, end_);
    last["share_besides_physics"] =
        1 - worst[static_cast<std::size_t>(StepProfile::Part::physics)] / total_ms(worst);
    for (const std::string& mode : r_.modes)
      last["reference_ms"][mode] =
          total_ms((mode == r_.options.mode ? own_beside_references() : r_.runs.at(mode))
                       .worst_server(first, end_));
    return last;
  }

  json description() const {
    const ExperimentOptions& o = r_.options;
    return {
        {"layout", o.workload.layout},
        {"servers", o.workload.servers},
        {"mode", o.mode},
        {"seconds", o.workload.seconds},
        {"rate_per_s", o.workload.rate_per_s},
        {"total_rate_per_s", total_rate_per_s(o.workload)},
        {"seed", o.workload.seed},
        {"repeats", o.repeats},
        {"reference_repeats", r_.modes.size() > 1 ? std::min(o.repeats, o.reference_repeats) : 0},
        {"single_repeats", r_.runs.contains("single") && r_.modes.size() > 1
                               ? std::min({o.repeats, o.reference_repeats, o.single_repeats})
                               : 0},
        {"latency_ms", o.latency_ms},
        {"jitter_ms", o.jitter_ms},
        {"loss_pct", o.loss_pct},
        {"cold_caches_s", o.cold_caches_s},
        {"region_m", o.workload.region_m},
        {"step_ms", tick_us / 1e3},
        {"tolerances",
         {{"mode", o.follow_latency ? "follow" : "fixed"},
          {"speed_mps", r_.world.tolerances.speed_mps},
          {"latency_ms", r_.world.tolerances.latency_ms},
          {"frame_time_ms", r_.world.tolerances.frame_time_ms}}}};
  }

  std::uint64_t injected() const {
    std::uint64_t sum = 0;
    for (const Injector& injector : r_.world.injectors)
      sum += injected_count(injector, r_.clock.last());
    return sum;
  }

  const ExperimentRecord& r_;
  std::size_t end_;
};

}  // namespace

json report_of(const ExperimentRecord& record) {
  return Report(record).make();
}

}  // namespace aureole
