// Sums while the run goes on, statistics of them afterwards.
#include "server/measure/run_record.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace aureole {
namespace {

nlohmann::json by_part(const FrameTime& frame) {
  return {{"physics", frame[static_cast<std::size_t>(StepProfile::Part::physics)]},
          {"aura", frame[static_cast<std::size_t>(StepProfile::Part::aura)]},
          {"decide", frame[static_cast<std::size_t>(StepProfile::Part::decide)]},
          {"wire", frame[static_cast<std::size_t>(StepProfile::Part::wire)]}};
}

/// The smallest value that at least `share` of all do not pass.
float quantile(std::vector<float> values, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double BucketClock::end_s(std::size_t bucket) const {
  return std::min(seconds_, static_cast<double>(bucket + 1) * (bucket_us / 1e6));
}

RunRecord::RunRecord(std::size_t servers, double seconds, double frame_limit_ms)
    : clock_(seconds), frame_limit_ms_(frame_limit_ms), buckets_(clock_.count()) {
  for (Bucket& bucket : buckets_) bucket.sums_ms.resize(servers);
}

void RunRecord::begin_repeat() {
  for (Bucket& bucket : buckets_) bucket.maxima_ms.push_back(0);
}

void RunRecord::note(Tick now, const MeasuredRun& run) {
  Bucket& bucket = buckets_[clock_.of(now)];
  ++bucket.ticks;
  const auto& frames = run.frames();
  double longest_ms = 0;
  for (std::size_t server = 0; server < frames.size(); ++server) {
    for (std::size_t part = 0; part < frames[server].size(); ++part)
      bucket.sums_ms[server][part] += frames[server][part];
    const double frame_ms = total_ms(frames[server]);
    bucket.maxima_ms.back() = std::max(bucket.maxima_ms.back(), frame_ms);
    bucket.frames_ms.push_back(static_cast<float>(frame_ms));
    longest_ms = std::max(longest_ms, frame_ms);
  }
  note_tolerances(bucket, run, longest_ms);
  if (!clock_.ends_with(now)) return;
  bucket.loads = run.loads();
  bucket.traffic = run.traffic();
  bucket.migrations = run.migrations();
  bucket.latency_tolerance_ms = run.latency_tolerance_ms();
}

void RunRecord::note_tolerances(Bucket& bucket, const MeasuredRun& run,
                                double longest_frame_ms) const {
  auto outside = run.outside_tolerances();
  bucket.keeps_tolerances = outside.has_value();
  if (!outside) return;
  constexpr auto frame_time = static_cast<std::size_t>(ToleranceEvent::Kind::frame_time);
  (*outside)[frame_time] = (*outside)[frame_time] || longest_frame_ms > frame_limit_ms_;
  bool any = false;
  for (std::size_t kind = 0; kind < outside->size(); ++kind) {
    if (!(*outside)[kind]) continue;
    ++bucket.outside[kind];
    any = true;
  }
  if (any) ++bucket.outside_any;
}

std::vector<FrameTime> RunRecord::means(std::size_t first, std::size_t end) const {
  std::vector<FrameTime> means(buckets_.front().sums_ms.size(), FrameTime{});
  std::uint64_t ticks = 0;
  for (std::size_t b = first; b < end; ++b) {
    ticks += buckets_[b].ticks;
    for (std::size_t server = 0; server < means.size(); ++server)
      for (std::size_t part = 0; part < means[server].size(); ++part)
        means[server][part] += buckets_[b].sums_ms[server][part];
  }
  for (FrameTime& mean : means)
    for (double& part : mean) part /= static_cast<double>(std::max<std::uint64_t>(ticks, 1));
  return means;
}

FrameTime RunRecord::worst_server(std::size_t first, std::size_t end) const {
  const auto all = means(first, end);
  return *std::max_element(all.begin(), all.end(), [](const FrameTime& a, const FrameTime& b) {
    return total_ms(a) < total_ms(b);
  });
}

double RunRecord::median_server_ms(std::size_t first, std::size_t end) const {
  std::vector<float> all;
  for (const FrameTime& mean : means(first, end)) all.push_back(static_cast<float>(total_ms(mean)));
  return double{quantile(std::move(all), 0.5)};
}

nlohmann::json RunRecord::tolerances(std::size_t first, std::size_t end) const {
  std::uint64_t ticks = 0, outside_any = 0;
  std::size_t frames = 0, in_time = 0;
  std::array<std::uint64_t, ToleranceEvent::kinds> outside{};
  bool kept_by_servers = false;
  for (std::size_t b = first; b < end; ++b) {
    const Bucket& bucket = buckets_[b];
    ticks += bucket.ticks;
    outside_any += bucket.outside_any;
    kept_by_servers = kept_by_servers || bucket.keeps_tolerances;
    for (std::size_t kind = 0; kind < outside.size(); ++kind) outside[kind] += bucket.outside[kind];
    frames += bucket.frames_ms.size();
    in_time += static_cast<std::size_t>(
        std::count_if(bucket.frames_ms.begin(), bucket.frames_ms.end(),
                      [&](float ms) { return double{ms} <= frame_limit_ms_; }));
  }
  nlohmann::json json = {
      {"frames_in_tolerance_share",
       static_cast<double>(in_time) / static_cast<double>(std::max<std::size_t>(frames, 1))},
      {"ticks_in_tolerance_share", nullptr},
      {"ticks_outside", nullptr}};
  if (!kept_by_servers || ticks == 0) return json;
  const auto share = [&](std::uint64_t n) {
    return static_cast<double>(n) / static_cast<double>(ticks);
  };
  json["ticks_in_tolerance_share"] = 1 - share(outside_any);
  json["ticks_outside"] = nlohmann::json::object();
  for (std::size_t kind = 0; kind < outside.size(); ++kind)
    json["ticks_outside"][std::string(name_of(static_cast<ToleranceEvent::Kind>(kind)))] =
        share(outside[kind]);
  return json;
}

nlohmann::json RunRecord::links(std::size_t b) const {
  const auto name = [&](int end) {
    const auto servers = static_cast<int>(buckets_[b].sums_ms.size());
    return end == servers ? nlohmann::json("gateway") : nlohmann::json(end);
  };
  nlohmann::json links = nlohmann::json::array();
  for (const LinkTraffic& link : buckets_[b].traffic) {
    LinkTraffic before;
    if (b > 0)
      for (const LinkTraffic& other : buckets_[b - 1].traffic)
        if (other.from == link.from && other.to == link.to) before = other;
    links.push_back({{"from", name(link.from)},
                     {"to", name(link.to)},
                     {"messages", link.messages - before.messages},
                     {"bytes", link.bytes - before.bytes}});
  }
  return links;
}

nlohmann::json RunRecord::to_json(std::size_t b) const {
  const Bucket& bucket = buckets_[b];
  const double repeats = static_cast<double>(bucket.maxima_ms.size());
  nlohmann::json server_ms = nlohmann::json::array(), bodies = server_ms, awake = server_ms;
  nlohmann::json server_split = nlohmann::json::array();
  for (const FrameTime& mean : means(b, b + 1)) {
    server_ms.push_back(total_ms(mean));
    server_split.push_back(by_part(mean));
  }
  std::uint64_t all = 0, foreign = 0;
  for (const ServerLoad& load : bucket.loads) {
    bodies.push_back(load.bodies);
    awake.push_back(load.awake);
    all += load.bodies;
    foreign += load.foreign;
  }
  const FrameTime worst = worst_server(b);
  nlohmann::json json = tolerances(b, b + 1);
  json.update({{"t_end_s", clock_.end_s(b)},
               {"max_frame_ms",
                std::accumulate(bucket.maxima_ms.begin(), bucket.maxima_ms.end(), 0.0) / repeats},
               {"worst_server_ms", total_ms(worst)},
               {"p99_frame_ms", quantile(bucket.frames_ms, 0.99)},
               {"split", by_part(worst)},
               {"server_ms", server_ms},
               {"server_split", server_split},
               {"median_server_ms", median_server_ms(b, b + 1)},
               {"latency_tolerance_ms", bucket.latency_tolerance_ms
                                            ? nlohmann::json(*bucket.latency_tolerance_ms)
                                            : nlohmann::json()},
               {"bodies", bodies},
               {"awake", awake},
               {"links", links(b)},
               {"migrations", bucket.migrations - (b > 0 ? buckets_[b - 1].migrations : 0)},
               {"foreign_hosted_share",
                all > 0 ? static_cast<double>(foreign) / static_cast<double>(all) : 0.0}});
  return json;
}

}  // namespace aureole
