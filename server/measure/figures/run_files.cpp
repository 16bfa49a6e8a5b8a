// Runs to and from DIR/runs/.
#include "server/measure/figures/run_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <tuple>

#include "server/base/hash.h"

namespace aureole {
namespace {

constexpr std::uintmax_t largest_report_bytes = 256u << 20;
constexpr double largest_number = 1e15;
constexpr int deepest = 32;  ///< Of values in values; a report has about five.

bool is_number(const nlohmann::json& value, const char* key) {
  const auto found = value.find(key);
  return found != value.end() && found->is_number();
}

/// What a file says goes into pages and onto terminals: short, and of characters that mean nothing.
bool is_plain(const std::string& text) {
  return !text.empty() && text.size() <= 100 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view(" ._+-").find(c) != std::string_view::npos;
  });
}

/// The first value that cannot be one of a report.
struct WrongValue {
  std::string path, what;
};

std::optional<WrongValue> wrong_value_in(const nlohmann::json& value, bool is_seed = false,
                                         int depth = 0) {
  // Seeds are names, not amounts.
  if (value.is_number() && !(is_seed && value.is_number_unsigned()) &&
      !(std::abs(value.get<double>()) <= largest_number))
    return WrongValue{"", fmt::format("is {:g}; expected a number from {:g} to {:g}",
                                      value.get<double>(), -largest_number, largest_number)};
  if (!value.is_structured()) return std::nullopt;
  if (depth == deepest)
    return WrongValue{"", fmt::format("is inside {} others; expected fewer", deepest)};
  for (const auto& item : value.items()) {
    auto wrong = wrong_value_in(item.value(), item.key() == "seed", depth + 1);
    if (!wrong) continue;
    const std::string name = is_plain(item.key()) ? item.key() : "?";
    wrong->path = wrong->path.empty() ? name : name + "/" + wrong->path;
    return wrong;
  }
  return std::nullopt;
}

}  // namespace

Result<std::string> build_version(const std::filesystem::path& executable) {
  std::ifstream file(executable, std::ios::binary);
  if (!file) return Error::format("cannot read {}, to know its version", executable.string());
  Hasher hasher;
  std::array<char, 65'536> part;
  while (file.read(part.data(), part.size()) || file.gcount() > 0)
    hasher.text({part.data(), static_cast<std::size_t>(file.gcount())});
  if (file.bad()) return Error::format("cannot read {} to its end", executable.string());
  return fmt::format("{} {:016x}", AUREOLE_VERSION, hasher.value());
}

std::filesystem::path run_file(const std::filesystem::path& out, const PlannedRun& run) {
  return out / "runs" / (run.name() + ".json");
}

Result<nlohmann::json> read_report(const std::filesystem::path& file) {
  std::error_code problem;
  const auto bytes = std::filesystem::file_size(file, problem);
  if (problem) return Error::format("{}: {}", file.string(), problem.message());
  if (bytes > largest_report_bytes)
    return Error::format("{} has {} bytes; a report has at most {}", file.string(), bytes,
                         largest_report_bytes);
  std::ifstream stream(file, std::ios::binary);
  auto report = nlohmann::json::parse(stream, nullptr, false);
  if (report.is_discarded()) return Error::format("{} is not JSON", file.string());
  const auto buckets = report.is_object() ? report.find("buckets") : report.end();
  if (!report.is_object() || buckets == report.end() || !buckets->is_array() || buckets->empty() ||
      !std::all_of(buckets->begin(), buckets->end(), [](const nlohmann::json& bucket) {
        return bucket.is_object() && is_number(bucket, "t_end_s");
      }))
    return Error::format("{} is no report of an experiment: it has no `buckets` with times",
                         file.string());
  if (const auto wrong = wrong_value_in(report))
    return Error::format("{}: `{}` {}", file.string(), wrong->path, wrong->what);
  return report;
}

Result<FinishedRun> read_run(const std::filesystem::path& file) {
  auto report = read_report(file);
  if (!report) return report.error();
  const auto made = report->find("run");
  if (made == report->end() || !made->is_object())
    return Error::format("{} does not say how it was made: it has no `run`", file.string());
  try {
    auto plan = planned_run_from(made->at("plan"));
    if (!plan) return Error::format("{}: {}", file.string(), plan.error().message);
    FinishedRun run{std::move(*plan),
                    made->at("arguments").get<std::vector<std::string>>(),
                    made->at("build").get<std::string>(),
                    {}};
    if (!is_plain(run.build))
      return Error::format(
          "{}: `run/build` is wrong; expected at most 100 letters, digits, spaces and dots",
          file.string());
    run.report = std::move(*report);
    return run;
  } catch (const nlohmann::json::exception& wrong) {
    return Error::format("{}: {}", file.string(), wrong.what());
  }
}

Status write_whole(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::path part = file;
  part += ".part";
  std::ofstream stream(part, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (!stream) return Error::format("cannot write {}", part.string());
  std::error_code problem;
  std::filesystem::rename(part, file, problem);
  if (problem) return Error::format("cannot write {}: {}", file.string(), problem.message());
  return Ok{};
}

Status write_run(const std::filesystem::path& file, const FinishedRun& run) {
  nlohmann::json whole = run.report;
  whole["run"] = {{"plan", to_json(run.plan)}, {"arguments", run.arguments}, {"build", run.build}};
  return write_whole(file, whole.dump(1) + "\n");
}

std::vector<FinishedRun> read_runs(const std::filesystem::path& out, const std::vector<Study>& only,
                                   std::vector<std::string>& notes) {
  std::vector<FinishedRun> runs;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(out / "runs", problem)) {
    if (entry.path().extension() != ".json") continue;
    auto run = read_run(entry.path());
    if (!run) {
      notes.push_back(run.error().message + "; it is left out");
    } else if (only.empty() || std::count(only.begin(), only.end(), run->plan.study) > 0) {
      runs.push_back(std::move(*run));
    }
  }
  if (problem) notes.push_back(fmt::format("{}: {}", (out / "runs").string(), problem.message()));
  std::sort(notes.begin(), notes.end());
  std::sort(runs.begin(), runs.end(), [](const FinishedRun& a, const FinishedRun& b) {
    return std::tuple(a.plan.study, a.plan.servers, a.plan.name()) <
           std::tuple(b.plan.study, b.plan.servers, b.plan.name());
  });
  return runs;
}

}  // namespace aureole
