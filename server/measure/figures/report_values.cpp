// Every look at a report allows for what is not there.
#include "server/measure/figures/report_values.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace aureole {
namespace {

using nlohmann::json;

const json nothing = json::array();

const json* member(const json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(std::string(key));
  return found == object.end() ? nullptr : &*found;
}

/// Two buckets of 5 s, or fewer if there are no more, with `after` more behind them.
std::vector<const json*> two_before(std::size_t after, const json& report) {
  const json& buckets = buckets_of(report);
  const std::size_t end = buckets.size() - std::min(buckets.size(), after);
  std::vector<const json*> two;
  for (std::size_t i = end - std::min<std::size_t>(end, 2); i < end; ++i)
    two.push_back(&buckets[i]);
  return two;
}

/// What "last 10 s" means everywhere.
std::vector<const json*> last_two(const json& report) {
  return two_before(0, report);
}

/// Each server's mean frame, sorted.
std::vector<double> server_ms_in(const std::vector<const json*>& buckets) {
  std::vector<double> means;
  for (const json* bucket : buckets) {
    const json* servers = member(*bucket, "server_ms");
    if (servers == nullptr || !servers->is_array()) return {};
    means.resize(std::max(means.size(), servers->size()));
    for (std::size_t server = 0; server < servers->size(); ++server)
      if ((*servers)[server].is_number())
        means[server] += (*servers)[server].get<double>() / static_cast<double>(buckets.size());
  }
  std::sort(means.begin(), means.end());
  return means;
}

std::optional<double> median_of(const std::vector<double>& sorted) {
  if (sorted.empty()) return std::nullopt;
  return (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]) / 2;
}

}  // namespace

std::optional<double> number_in(const json& object, std::string_view key) {
  const json* found = member(object, key);
  if (found == nullptr || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

const json& buckets_of(const json& report, std::string_view reference) {
  const json* holder = &report;
  if (!reference.empty()) {
    const json* references = member(report, "references");
    holder = references == nullptr ? nullptr : member(*references, reference);
  }
  const json* buckets = holder == nullptr ? nullptr : member(*holder, "buckets");
  return buckets != nullptr && buckets->is_array() ? *buckets : nothing;
}

std::vector<Sample> by_bucket(const json& buckets, std::string_view key) {
  std::vector<Sample> samples;
  for (const json& bucket : buckets) {
    const auto t_s = number_in(bucket, "t_end_s"), value = number_in(bucket, key);
    if (t_s && value) samples.push_back({*t_s, *value});
  }
  return samples;
}

std::vector<std::vector<Sample>> bodies_by_server(const json& buckets) {
  std::vector<std::vector<Sample>> servers;
  for (const json& bucket : buckets) {
    const auto t_s = number_in(bucket, "t_end_s");
    const json* bodies = member(bucket, "bodies");
    if (!t_s || bodies == nullptr || !bodies->is_array()) continue;
    servers.resize(std::max(servers.size(), bodies->size()));
    for (std::size_t server = 0; server < bodies->size(); ++server)
      if ((*bodies)[server].is_number())
        servers[server].push_back({*t_s, (*bodies)[server].get<double>()});
  }
  return servers;
}

std::optional<double> number_at(const json& report, std::string_view path) {
  const json* at = &report;
  for (auto slash = path.find('/'); slash != std::string_view::npos; slash = path.find('/')) {
    at = member(*at, path.substr(0, slash));
    if (at == nullptr) return std::nullopt;
    path.remove_prefix(slash + 1);
  }
  return number_in(*at, path);
}

std::optional<double> sum_of(const json& report, std::string_view key) {
  double sum = 0;
  for (const json& bucket : buckets_of(report)) {
    const auto value = number_in(bucket, key);
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum;
}

std::optional<FrameParts> last_parts(const json& report) {
  FrameParts parts;
  const auto last = last_two(report);
  for (const json* bucket : last) {
    const json* split = member(*bucket, "split");
    if (split == nullptr) return std::nullopt;
    for (std::size_t part = 0; part < parts.ms.size(); ++part) {
      const auto value = number_in(*split, FrameParts::names[part]);
      if (!value) return std::nullopt;
      parts.ms[part] += *value / static_cast<double>(last.size());
    }
  }
  return parts;
}

std::vector<double> last_server_ms(const json& report) {
  return server_ms_in(last_two(report));
}

std::optional<double> median_server_ms(const json& report) {
  if (const auto value = number_at(report, "last_10_s/median_server_ms")) return value;
  return median_of(last_server_ms(report));
}

std::optional<double> median_server_ms_before(const json& report) {
  return median_of(server_ms_in(two_before(2, report)));
}

std::optional<double> bytes_per_server_and_s(const json& report) {
  double bytes = 0, seconds = 0;
  std::size_t servers = 0;
  for (const json& bucket : buckets_of(report)) {
    const json *links = member(bucket, "links"), *bodies = member(bucket, "bodies");
    const auto t_s = number_in(bucket, "t_end_s");
    if (links == nullptr || !links->is_array() || bodies == nullptr || !t_s) return std::nullopt;
    servers = bodies->size();
    seconds = *t_s;
    for (const json& link : *links) bytes += number_in(link, "bytes").value_or(0);
  }
  if (servers == 0 || seconds <= 0) return std::nullopt;
  return bytes / static_cast<double>(servers) / seconds;
}

}  // namespace aureole
