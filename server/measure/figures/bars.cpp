// Each demand on the runs, judged.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "server/measure/figures/plots/figures.h"
#include "server/measure/figures/report_values.h"
#include "server/measure/figures/tables.h"

namespace aureole {
namespace {

constexpr int repeats_wanted = 5;      ///< For maxima: one slow step shows in them.
constexpr double judged_after_s = 10;  ///< The first buckets hold hardly anything.

const FinishedRun* find(const std::vector<FinishedRun>& runs, Study study, const std::string& mode,
                        int servers) {
  const FinishedRun* found = nullptr;
  for (const FinishedRun& run : runs) {
    if (!is_of(study, run.plan) || run.plan.mode != mode || run.plan.servers != servers) continue;
    if (found == nullptr || run.plan.study == study) found = &run;
  }
  return found;
}

std::string place(Study study, int servers) {
  return fmt::format("{} {}", study == Study::fig5 ? "columns" : "corners", servers);
}

class Bars {
 public:
  explicit Bars(const std::vector<FinishedRun>& runs) : runs_(runs) {}

  std::vector<BarResult> all() {
    efficiency();
    overhead();
    falls(Study::fig5, {1, 2, 4, 10});
    falls(Study::fig7, {1, 4, 9});
    zero("missed interactions in tolerance",
         [](const auto& report) { return sum_of(report, "missed_interactions_in_tolerance"); });
    zero("bodies lost", [](const auto& report) { return number_at(report, "bodies_lost"); });
    zero("bodies doubled",
         [](const auto& report) { return number_at(report, "bodies_duplicated"); });
    bytes();
    weak();
    return std::move(bars_);
  }

 private:
  void add(std::string bar, std::string wanted, std::string came, Verdict verdict) {
    bars_.push_back({std::move(bar), std::move(wanted), std::move(came), verdict});
  }

  void at_least(std::string bar, double limit, std::optional<double> value) {
    if (!value)
      return add(std::move(bar), fmt::format("at least {:.2f}", limit), "no run", Verdict::unknown);
    add(std::move(bar), fmt::format("at least {:.2f}", limit), fmt::format("{:.3f}", *value),
        *value >= limit ? Verdict::passed : Verdict::failed);
  }

  std::optional<double> value_of(Study study, int servers, std::string_view key) const {
    const FinishedRun* run = find(runs_, study, "adaptive", servers);
    return run == nullptr ? std::nullopt : number_at(run->report, key);
  }

  void efficiency() {
    const std::pair<Study, int> places[] = {
        {Study::fig5, 2}, {Study::fig5, 4}, {Study::fig5, 10}, {Study::fig7, 4}, {Study::fig7, 9}};
    for (const auto& [study, servers] : places) {
      at_least(fmt::format("`adaptive`, {}: last 10 s against `cut`", place(study, servers)), 0.9,
               value_of(study, servers, "last_10_s/efficiency"));
      at_least(fmt::format("`adaptive`, {}: last 10 s against `ideal`", place(study, servers)), 0.8,
               value_of(study, servers, "last_10_s/efficiency_ideal"));
    }
  }

  void overhead() {
    const auto share = value_of(Study::fig5, 10, "last_10_s/share_besides_physics");
    add("`adaptive`, columns 10: auras, decisions and wire, last 10 s", "at most 5 % of a frame",
        share ? fmt::format("{:.2f} %", *share * 100) : "no run",
        !share           ? Verdict::unknown
        : *share <= 0.05 ? Verdict::passed
                         : Verdict::failed);
  }

  void falls(Study study, const std::vector<int>& counts) {
    for (const char* key : {"worst_server_ms", "max_frame_ms"})
      for (std::size_t i = 0; i + 1 < counts.size(); ++i)
        fall(study, counts[i], counts[i + 1], key);
  }

  void fall(Study study, int few, int many, const std::string& key) {
    const std::string bar = fmt::format("`adaptive`, {} → {}: `{}`", place(study, few), many, key),
                      wanted = "falls in every 5 s after the first 10 s";
    const FinishedRun *before = find(runs_, study, "adaptive", few),
                      *after = find(runs_, study, "adaptive", many);
    if (before == nullptr || after == nullptr) return add(bar, wanted, "no run", Verdict::unknown);
    std::size_t looked = 0, fell = 0;
    std::string rises;
    const auto with_many = by_bucket(buckets_of(after->report), key);
    for (const Sample& a : by_bucket(buckets_of(before->report), key))
      for (const Sample& b : with_many) {
        if (a.t_s != b.t_s || a.t_s <= judged_after_s) continue;
        ++looked;
        fell += b.value < a.value ? 1 : 0;
        if (!(b.value < a.value))
          rises += fmt::format("{}{:g} s: {:.2f} → {:.2f} ms", rises.empty() ? "; " : ", ", a.t_s,
                               a.value, b.value);
      }
    std::string came = fmt::format("in {} of {}{}", fell, looked, rises);
    Verdict verdict = fell == looked ? Verdict::passed : Verdict::failed;
    if (looked == 0) verdict = Verdict::unknown;
    const int repeats = std::min(before->plan.repeats, after->plan.repeats);
    if (key == "max_frame_ms" && repeats < repeats_wanted) {
      came += fmt::format("; maxima need {} repeats, there are {}", repeats_wanted, repeats);
      verdict = Verdict::unknown;
    }
    add(bar, wanted, came, verdict);
  }

  /// In every run of servers that talk.
  void zero(const std::string& what,
            const std::function<std::optional<double>(const nlohmann::json&)>& value) {
    for (const char* mode : {"adaptive", "paper"}) {
      std::size_t looked = 0;
      std::string others;
      for (const FinishedRun& run : runs_) {
        if (run.plan.mode != mode) continue;
        const auto count = value(run.report);
        if (!count) continue;
        ++looked;
        if (*count != 0)
          others +=
              fmt::format("{}{:g} in {}", others.empty() ? "" : ", ", *count, run.plan.name());
      }
      std::string came =
          fmt::format("{}{} runs judged", others.empty() ? "0; " : others + "; ", looked);
      if (looked == 0) came = "no run that was judged";
      add(fmt::format("`{}`, every run: {}", mode, what), "0", came,
          looked == 0      ? Verdict::unknown
          : others.empty() ? Verdict::passed
                           : Verdict::failed);
    }
  }

  /// The most of any run of Fig. 5 and Fig. 7.
  void at_most(const std::string& what, const char* key, double limit, const char* unit) {
    std::optional<double> most;
    std::string name;
    for (const FinishedRun& run : runs_) {
      if (run.plan.study != Study::fig5 && run.plan.study != Study::fig7) continue;
      const auto value = number_at(run.report, key);
      if (!value || (most && *most >= *value)) continue;
      most = value;
      name = run.plan.name();
    }
    add(what, fmt::format("at most {:g}{}", limit, unit),
        most ? fmt::format("{:.4g}{} at most ({})", *most, unit, name) : "no run tells it",
        !most            ? Verdict::unknown
        : *most <= limit ? Verdict::passed
                         : Verdict::failed);
  }

  void bytes() {
    at_most("Fig. 5 and 7: for a moving aura and tick", "total/wire/aura_bytes_per_moving_tick", 32,
            " bytes");
    at_most("Fig. 5 and 7: for a moving replica and tick",
            "total/wire/replica_bytes_per_moving_tick", 20, " bytes");
    at_most("Fig. 5 and 7: key states on top of that", "total/wire/replica_key_share", 0.25, "");
  }

  void weak() {
    const FinishedRun *few = find(runs_, Study::weak, "adaptive", 4),
                      *many = find(runs_, Study::weak, "adaptive", 64);
    const double before = few == nullptr ? 0 : median_server_ms(few->report).value_or(0),
                 after = many == nullptr ? 0 : median_server_ms(many->report).value_or(0);
    const std::string bar = "weak scaling: the median server's frame at 64 against 4 servers",
                      wanted = "at most 10 % apart";
    if (before <= 0 || after <= 0) return add(bar, wanted, "no run", Verdict::unknown);
    const double more = after / before - 1;
    add(bar, wanted,
        fmt::format("{:+.1f} % ({:.3f} → {:.3f} ms{})", more * 100, before, after,
                    with_shared_caches(*few, *many)),
        std::abs(more) <= 0.1 ? Verdict::passed : Verdict::failed);
  }

  /// How the same looked just before caches were cold, if they were.
  static std::string with_shared_caches(const FinishedRun& few, const FinishedRun& many) {
    if (few.plan.cold_caches_s <= 0 || many.plan.cold_caches_s <= 0) return "";
    const auto before = median_server_ms_before(few.report),
               after = median_server_ms_before(many.report);
    if (!before || !after || *before <= 0) return "; caches cold";
    return fmt::format("; caches cold; with shared ones before that {:+.1f} %, {:.3f} → {:.3f} ms",
                       (*after / *before - 1) * 100, *before, *after);
  }

  const std::vector<FinishedRun>& runs_;
  std::vector<BarResult> bars_;
};

}  // namespace

std::vector<BarResult> bars_of(const std::vector<FinishedRun>& runs) {
  return Bars(runs).all();
}

}  // namespace aureole
