// Sums while the run goes on, statistics of them afterwards.
#include "server/measure/run_record.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/aura/aura_radius.h"

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

RunRecord::RunRecord(std::size_t servers, double seconds)
    : clock_(seconds), buckets_(clock_.count()) {
  for (Bucket& bucket : buckets_) bucket.sums_ms.resize(servers);
}

void RunRecord::begin_repeat() {
  for (Bucket& bucket : buckets_) bucket.maxima_ms.push_back(0);
}

void RunRecord::note(Tick now, const MeasuredRun& run) {
  Bucket& bucket = buckets_[clock_.of(now)];
  ++bucket.ticks;
  const auto& frames = run.frames();
  for (std::size_t server = 0; server < frames.size(); ++server) {
    for (std::size_t part = 0; part < frames[server].size(); ++part)
      bucket.sums_ms[server][part] += frames[server][part];
    const double frame_ms = total_ms(frames[server]);
    bucket.maxima_ms.back() = std::max(bucket.maxima_ms.back(), frame_ms);
    bucket.frames_ms.push_back(static_cast<float>(frame_ms));
  }
  if (!clock_.ends_with(now)) return;
  bucket.loads = run.loads();
  bucket.traffic = run.traffic();
  bucket.migrations = run.migrations();
}

FrameTime RunRecord::worst_server(std::size_t first, std::size_t end) const {
  FrameTime worst{};
  for (std::size_t server = 0; server < buckets_.front().sums_ms.size(); ++server) {
    FrameTime mean{};
    std::uint64_t ticks = 0;
    for (std::size_t b = first; b < end; ++b) {
      ticks += buckets_[b].ticks;
      for (std::size_t part = 0; part < mean.size(); ++part)
        mean[part] += buckets_[b].sums_ms[server][part];
    }
    for (double& part : mean) part /= static_cast<double>(std::max<std::uint64_t>(ticks, 1));
    if (total_ms(mean) > total_ms(worst)) worst = mean;
  }
  return worst;
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
  const double frame_limit_ms = AuraTolerances{}.frame_time_ms;
  const auto in_time = std::count_if(bucket.frames_ms.begin(), bucket.frames_ms.end(),
                                     [&](float ms) { return double{ms} <= frame_limit_ms; });
  nlohmann::json server_ms = nlohmann::json::array(), bodies = server_ms, awake = server_ms;
  for (const FrameTime& sum : bucket.sums_ms)
    server_ms.push_back(total_ms(sum) / static_cast<double>(bucket.ticks));
  std::uint64_t all = 0, foreign = 0;
  for (const ServerLoad& load : bucket.loads) {
    bodies.push_back(load.bodies);
    awake.push_back(load.awake);
    all += load.bodies;
    foreign += load.foreign;
  }
  const FrameTime worst = worst_server(b);
  return {{"t_end_s", clock_.end_s(b)},
          {"max_frame_ms",
           std::accumulate(bucket.maxima_ms.begin(), bucket.maxima_ms.end(), 0.0) / repeats},
          {"worst_server_ms", total_ms(worst)},
          {"p99_frame_ms", quantile(bucket.frames_ms, 0.99)},
          {"split", by_part(worst)},
          {"server_ms", server_ms},
          {"frames_in_tolerance_share",
           static_cast<double>(in_time) / static_cast<double>(bucket.frames_ms.size())},
          {"bodies", bodies},
          {"awake", awake},
          {"links", links(b)},
          {"migrations", bucket.migrations - (b > 0 ? buckets_[b - 1].migrations : 0)},
          {"foreign_hosted_share",
           all > 0 ? static_cast<double>(foreign) / static_cast<double>(all) : 0.0}};
}

}  // namespace aureole
