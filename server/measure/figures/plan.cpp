// The table of studies, and the runs that its rows stand for.
#include "server/measure/figures/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/measure/figures/run_ranges.h"

namespace aureole {
namespace {

/// What a row varies beside servers and kinds.
enum class Knob { none, latency, jitter, loss, speed_tolerance, latency_tolerance, region };

/// Who is measured.
struct Kind {
  const char* mode;
  bool follow = false;
  bool once = false;  ///< However often the row is repeated.
};

struct Row {
  Study study;
  const char* layout;
  std::vector<int> servers;
  std::vector<Kind> kinds;
  double seconds;
  int repeats;
  Knob knob = Knob::none;
  std::vector<double> values = {0};
  PlannedNetwork network = {};
  PlannedTolerances tolerances = {};
  double rate_per_s = 160;
  bool references = false;
  double cold_caches_s = 0;
};

const std::vector<Kind> both = {{"adaptive"}, {"paper"}};
const std::vector<Kind> ours = {{"adaptive"}};
/// What is asked of maxima over repeats is asked of `adaptive`.
const std::vector<Kind> both_figures = {{"adaptive"}, {"paper", false, true}};
const std::vector<Kind> fixed_and_following = {{"adaptive"}, {"adaptive", true}, {"paper"}};

/// Studies of the network vary one property of it and leave the others at these. Half of the
/// latency as jitter would hide what latency alone does.
constexpr PlannedNetwork slow = {20, 0, 0};
/// What must be larger than its latency tolerance to show what a small aura misses.
constexpr PlannedNetwork late = {20, 10, 0};
/// 60 s of it are 6,300 bodies on 4 servers, 100,800 on 64.
constexpr double weak_rate_per_s = 105;

// clang-format off
/// Everything that the paper shows and the studies ask for. A grid's rate is that of 4 servers. One
/// region is the same world in both figures; see is_of().
const std::vector<Row>& full_table() {
  static const std::vector<Row> table = {
    {Study::fig5, "column", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, both_figures, 60, 5, Knob::none, {0}, {}, {}, 160, true},
    {Study::fig7, "corner", {3, 4, 9},                       both_figures, 60, 5, Knob::none, {0}, {}, {}, 160, true},
    {Study::latency, "corner", {4}, fixed_and_following, 30, 1, Knob::latency, {0, 2, 5, 10, 20, 35, 50, 75, 100}, {0, 0, 0}},
    {Study::latency, "corner", {4}, fixed_and_following, 30, 1, Knob::jitter,  {5, 10, 15, 20},   slow},
    {Study::latency, "corner", {4}, fixed_and_following, 30, 1, Knob::loss,    {0.1, 0.5, 1, 2, 5}, slow},
    {Study::tolerances, "corner", {4}, both, 30, 1, Knob::speed_tolerance,   {4, 8, 16, 32, 64}},
    {Study::tolerances, "corner", {4}, both, 30, 1, Knob::latency_tolerance, {1, 2, 5, 10, 20, 40, 80}, late},
    {Study::weak, "grid", {4, 16, 64}, ours, 60, 1, Knob::none, {0}, {}, {}, weak_rate_per_s, false, 10},
    {Study::regions, "corner", {4}, ours, 60, 1, Knob::region, {100, 150, 200, 300}, {}, {}, 160, true},
    {Study::regions, "column", {2}, ours, 60, 1, Knob::region, {150, 300},           {}, {}, 160, true},
  };
  return table;
}

/// About half an hour of one core.
const std::vector<Row>& quick_table() {
  static const std::vector<Row> table = {
    {Study::fig5, "column", {1, 2, 4, 10}, both_figures, 20, 1, Knob::none, {0}, {}, {}, 160, true},
    {Study::fig7, "corner", {4, 9},        both_figures, 20, 1, Knob::none, {0}, {}, {}, 160, true},
    {Study::latency, "corner", {4}, fixed_and_following, 15, 1, Knob::latency, {0, 5, 20, 50, 100}, {0, 0, 0}},
    {Study::latency, "corner", {4}, fixed_and_following, 15, 1, Knob::jitter,  {10, 20}, slow},
    {Study::latency, "corner", {4}, fixed_and_following, 15, 1, Knob::loss,    {1, 5},   slow},
    {Study::tolerances, "corner", {4}, both, 15, 1, Knob::speed_tolerance,   {8, 32, 64}},
    {Study::tolerances, "corner", {4}, both, 15, 1, Knob::latency_tolerance, {2, 20, 80}, late},
    {Study::weak, "grid", {4, 16, 64}, ours, 15, 1, Knob::none, {0}, {}, {}, weak_rate_per_s, false, 10},
    {Study::regions, "corner", {4}, ours, 20, 1, Knob::region, {150, 300}, {}, {}, 160, true},
  };
  return table;
}
// clang-format on

void turn(Knob knob, double value, PlannedRun& run) {
  switch (knob) {
    case Knob::none:
      return;
    case Knob::latency:
      run.network.latency_ms = value;
      return;
    case Knob::jitter:
      run.network.jitter_ms = value;
      return;
    case Knob::loss:
      run.network.loss_pct = value;
      return;
    case Knob::speed_tolerance:
      run.tolerances.speed_mps = value;
      return;
    case Knob::latency_tolerance:
      run.tolerances.latency_ms = value;
      return;
    case Knob::region:
      run.region_m = value;
      return;
  }
}

void add_runs(const Row& row, const PlanOptions& options, std::vector<PlannedRun>& plan) {
  for (const double value : row.values)
    for (const int servers : row.servers)
      for (const Kind& kind : row.kinds) {
        const auto& wanted = options.servers;
        if (!wanted.empty() && std::count(wanted.begin(), wanted.end(), servers) == 0) continue;
        PlannedRun run;
        run.study = row.study;
        run.layout = row.layout;
        run.servers = servers;
        run.mode = kind.mode;
        run.seconds = options.seconds.value_or(row.seconds);
        run.rate_per_s = options.rate_per_s.value_or(row.rate_per_s);
        run.repeats = kind.once ? 1 : options.repeats.value_or(row.repeats);
        run.seed = options.seed;
        run.cold_caches_s = row.cold_caches_s;
        run.network = row.network;
        run.tolerances = row.tolerances;
        run.tolerances.follow = kind.follow;
        turn(row.knob, value, run);
        // One server is all of its limits itself, and nothing meets across a boundary.
        run.references = row.references && servers > 1;
        run.single = run.references && kind.mode == std::string_view("adaptive") &&
                     row.study != Study::regions;
        // Oracles of 100,000 bodies would take longer than everything else together.
        run.judged = servers > 1 && servers <= 16;
        plan.push_back(std::move(run));
      }
}

/// A number as one would type it, and as a part of a file's name.
std::string plain(double value) {
  return fmt::format("{:g}", value);
}

/// Reads fields as the command line takes them, and keeps what is wrong with the first that is not
/// so. Throws nlohmann's exception where a field is missing.
class Fields {
 public:
  explicit Fields(const nlohmann::json& object) : object_(object) {}

  void number(const char* key, run_ranges::Range range, double& into) {
    const auto& value = object_.at(key);
    if (value.is_number() && contains(range, value.get<double>()))
      into = value.get<double>();
    else
      refuse(key, fmt::format("a number from {:g} to {:g}", range.from, range.to));
  }
  void whole(const char* key, run_ranges::Range range, int& into) {
    const auto& value = object_.at(key);
    // As a double first: whole numbers may be too large for an int.
    if (value.is_number_integer() && contains(range, value.get<double>()))
      into = value.get<int>();
    else
      refuse(key, fmt::format("a whole number from {:g} to {:g}", range.from, range.to));
  }
  void seed(const char* key, std::uint64_t& into) {
    const auto& value = object_.at(key);
    if (value.is_number_unsigned())
      into = value.get<std::uint64_t>();
    else
      refuse(key, "a whole number that is not negative");
  }
  void word(const char* key, std::initializer_list<const char*> known, std::string& into) {
    const auto& value = object_.at(key);
    if (value.is_string() && std::count(known.begin(), known.end(), value.get<std::string>()) > 0)
      into = value.get<std::string>();
    else
      refuse(key, fmt::format("one of {}", fmt::join(known, ", ")));
  }
  void flag(const char* key, bool& into) {
    const auto& value = object_.at(key);
    if (value.is_boolean())
      into = value.get<bool>();
    else
      refuse(key, "true or false");
  }
  Status end() const { return end_; }

 private:
  static bool contains(run_ranges::Range range, double value) {
    return value >= range.from && value <= range.to;
  }
  /// Says nothing of the value: what stands in a file may be any text of any length.
  void refuse(const char* key, const std::string& expected) {
    if (end_) end_ = Error::format("`{}` of the run is wrong; expected {}", key, expected);
  }

  const nlohmann::json& object_;
  Status end_ = Ok{};
};

}  // namespace

std::string_view word_of(Study study) {
  switch (study) {
    case Study::fig5:
      return "fig5";
    case Study::fig7:
      return "fig7";
    case Study::latency:
      return "latency";
    case Study::tolerances:
      return "tolerances";
    case Study::weak:
      return "weak";
    case Study::regions:
      return "regions";
  }
  return "";
}

std::optional<Study> study_from(std::string_view word) {
  for (const Study study : every_study)
    if (word_of(study) == word) return study;
  return std::nullopt;
}

std::string PlannedRun::name() const {
  std::string name = fmt::format("{}-{}-{:02}-{}", word_of(study), layout, servers, mode);
  if (study == Study::latency)
    name += fmt::format("-latency-{}-jitter-{}-loss-{}-{}", plain(network.latency_ms),
                        plain(network.jitter_ms), plain(network.loss_pct),
                        tolerances.follow ? "follow" : "fixed");
  if (study == Study::tolerances)
    name += fmt::format("-latency-{}-speed-tolerance-{}-latency-tolerance-{}",
                        plain(network.latency_ms), plain(tolerances.speed_mps),
                        plain(tolerances.latency_ms));
  if (study == Study::regions) name += fmt::format("-region-{}", plain(region_m));
  return name;
}

std::vector<std::string> PlannedRun::arguments() const {
  std::vector<std::string> words = {"experiment", layout};
  const auto option = [&](const char* name, std::string value) {
    words.insert(words.end(), {name, std::move(value)});
  };
  option("--servers", std::to_string(servers));
  option("--mode", mode);
  option("--seconds", plain(seconds));
  option("--rate", plain(rate_per_s));
  option("--seed", std::to_string(seed));
  option("--repeat", std::to_string(repeats));
  option("--latency-ms", plain(network.latency_ms));
  option("--jitter-ms", plain(network.jitter_ms));
  // What is as the paper has it is left to the defaults.
  if (region_m != PlannedRun{}.region_m) option("--region", plain(region_m));
  if (network.loss_pct != PlannedNetwork{}.loss_pct) option("--loss-pct", plain(network.loss_pct));
  if (tolerances.speed_mps != PlannedTolerances{}.speed_mps)
    option("--speed-tolerance", plain(tolerances.speed_mps));
  if (tolerances.latency_ms != PlannedTolerances{}.latency_ms)
    option("--latency-tolerance", plain(tolerances.latency_ms));
  if (tolerances.follow) option("--tolerances", "follow");
  if (!judged) words.push_back("--no-judge");
  if (!references) words.push_back("--no-references");
  if (references && !single) words.push_back("--no-single");
  if (single && repeats > 1) option("--single-repeats", "1");
  if (cold_caches_s > 0) option("--cold-caches", plain(cold_caches_s));
  return words;
}

double PlannedRun::cost() const {
  // Every tick steps what has come so far. The oracles take about as long as the servers; so do
  // `cut` and `ideal`, beside each repeat, and `single`, beside one, as all servers together.
  const double rate = study == Study::weak ? rate_per_s * servers / 4 : rate_per_s;
  const double world = seconds * seconds * rate;
  return world * (repeats * (references ? 3.0 : 1.0) + (single ? 1.0 : 0.0) + (judged ? 2.0 : 0.0));
}

nlohmann::json to_json(const PlannedRun& run) {
  return {{"study", word_of(run.study)},
          {"layout", run.layout},
          {"servers", run.servers},
          {"mode", run.mode},
          {"seconds", run.seconds},
          {"rate_per_s", run.rate_per_s},
          {"repeats", run.repeats},
          {"seed", run.seed},
          {"region_m", run.region_m},
          {"latency_ms", run.network.latency_ms},
          {"jitter_ms", run.network.jitter_ms},
          {"loss_pct", run.network.loss_pct},
          {"speed_tolerance_mps", run.tolerances.speed_mps},
          {"latency_tolerance_ms", run.tolerances.latency_ms},
          {"tolerances_follow", run.tolerances.follow},
          {"judged", run.judged},
          {"references", run.references},
          {"single", run.single},
          {"cold_caches_s", run.cold_caches_s}};
}

Result<PlannedRun> planned_run_from(const nlohmann::json& value) {
  try {
    PlannedRun run;
    const auto study = study_from(value.at("study").get<std::string>());
    if (!study) return Error{"`study` is none of the studies"};
    run.study = *study;
    Fields fields(value);
    fields.word("layout", run_ranges::layouts, run.layout);
    fields.whole("servers", run_ranges::servers, run.servers);
    fields.word("mode", run_ranges::modes, run.mode);
    fields.number("seconds", run_ranges::seconds, run.seconds);
    fields.number("rate_per_s", run_ranges::rate_per_s, run.rate_per_s);
    fields.whole("repeats", run_ranges::repeats, run.repeats);
    fields.seed("seed", run.seed);
    fields.number("latency_ms", run_ranges::message_ms, run.network.latency_ms);
    fields.number("jitter_ms", run_ranges::message_ms, run.network.jitter_ms);
    fields.number("loss_pct", run_ranges::loss_pct, run.network.loss_pct);
    fields.number("speed_tolerance_mps", run_ranges::speed_tolerance_mps, run.tolerances.speed_mps);
    fields.number("latency_tolerance_ms", run_ranges::latency_tolerance_ms,
                  run.tolerances.latency_ms);
    fields.flag("tolerances_follow", run.tolerances.follow);
    fields.flag("judged", run.judged);
    fields.flag("references", run.references);
    // Files of older builds do not say these.
    run.single = run.references && run.mode == "adaptive";
    if (value.contains("single")) fields.flag("single", run.single);
    if (value.contains("cold_caches_s"))
      fields.number("cold_caches_s", run_ranges::cold_caches_s, run.cold_caches_s);
    if (value.contains("region_m"))
      fields.number("region_m", run_ranges::region_m, run.region_m);
    if (const Status end = fields.end(); !end) return end.error();
    return run;
  } catch (const nlohmann::json::exception& wrong) {
    return Error{wrong.what()};
  }
}

std::vector<PlannedRun> plan_of(const PlanOptions& options) {
  std::vector<PlannedRun> plan;
  for (const Row& row : options.quick ? quick_table() : full_table())
    if (options.only.empty() || std::count(options.only.begin(), options.only.end(), row.study) > 0)
      add_runs(row, options, plan);
  return plan;
}

}  // namespace aureole
