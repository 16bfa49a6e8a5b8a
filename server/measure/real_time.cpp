// Children, their status, and their CPU time.
#include "server/measure/real_time.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "server/measure/run_record.h"
#include "server/measure/workload/workload_file.h"
#include "server/ops/http_get.h"
#include "server/ops/ports.h"
#include "server/ops/temporary_folder.h"
#include "server/ops/status_table.h"
#include "server/play/child_process.h"
#include "server/play/command_lines.h"

namespace aureole {
namespace {

constexpr int status_limit_ms = 1000;
/// A server that left more out than this share of its ticks has not done the same work.
constexpr double skipped_share_max = 0.5;

double now_s() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

class RealWorld {
 public:
  RealWorld(const WorldDefinition& world, const RealTimeOptions& options,
            const std::function<void(const std::string&)>& progress)
      : world_(world), o_(options), progress_(progress) {}

  Status start() {
    auto folder = TemporaryFolder::make();
    if (!folder) return folder.error();
    folder_ = std::move(*folder);
    const std::filesystem::path file = folder_->path() / "world.json";
    std::ofstream(file) << workload_file(world_).dump(1);
    // The gateway serves a page, which nobody asks for.
    std::ofstream(folder_->path() / "index.html") << "<!doctype html><title>measured</title>";
    const auto count = static_cast<int>(world_.regions.size());
    const auto ports = free_loopback_ports(count + 1, static_cast<std::uint32_t>(getpid()) + 31u);
    if (!ports) return ports.error();
    WorldPlan plan;
    plan.world = file.string();
    plan.host = "127.0.0.1";
    plan.port = ports->back();
    plan.web_root = folder_->path().string();
    plan.log_level = "error";
    plan.region_ports.assign(ports->begin(), ports->end() - 1);
    for (const ProcessPlan& process : processes_of(plan)) {
      auto child = ChildProcess::start(o_.executable, process.arguments);
      if (!child) return child.error();
      names_.push_back(process.name);
      children_.push_back(std::move(*child));
    }
    status_url_ = fmt::format("http://127.0.0.1:{}/api/status", plan.port);
    return wait_until_linked();
  }

  /// By bucket, from the moment that world time began.
  Result<std::vector<RealTimeBucket>> measure() {
    const BucketClock clock(o_.seconds);
    std::vector<RealTimeBucket> buckets;
    const double began_s = now_s() - world_time_s_;
    double since_s = world_time_s_;
    auto before = cpu_ns();
    if (!before) return before.error();
    for (std::size_t b = 0; b < clock.count(); ++b) {
      const double end_s = clock.end_s(b);
      while (now_s() - began_s < end_s) {
        if (auto well = look(std::min(0.2, end_s - (now_s() - began_s))); !well)
          return well.error();
        progress_(fmt::format("in real time: {:.0f} of {:.0f} s", now_s() - began_s, o_.seconds));
      }
      const auto after = cpu_ns();
      if (!after) return after.error();
      auto status = ask();
      if (!status) return status.error();
      auto bucket = bucket_of(end_s, (end_s - since_s) / (tick_us / 1e6), *before, *after, *status);
      if (!bucket) return bucket.error();
      buckets.push_back(std::move(*bucket));
      before = after;
      since_s = end_s;
    }
    return buckets;
  }

 private:
  Result<RealTimeBucket> bucket_of(double end_s, double ticks,
                                   const std::vector<std::int64_t>& before,
                                   const std::vector<std::int64_t>& after,
                                   const WorldStatus& status) {
    if (status.regions.size() != after.size())
      return Error::format("the gateway tells of {} regions; expected {}", status.regions.size(),
                           after.size());
    RealTimeBucket bucket;
    bucket.t_end_s = end_s;
    skipped_.resize(after.size(), 0);
    for (std::size_t r = 0; r < after.size(); ++r) {
      const auto& region = status.regions[r];
      const std::int64_t skipped = region.skipped_ticks - skipped_[r];
      skipped_[r] = region.skipped_ticks;
      if (static_cast<double>(skipped) > skipped_share_max * ticks)
        return Error::format(
            "{} left out {} of {:.0f} ticks up to {:.0f} s: this machine cannot run {} servers in "
            "real time now",
            names_[r], skipped, ticks, end_s, after.size());
      bucket.server_ms.push_back(static_cast<double>(after[r] - before[r]) / 1e6 /
                                 (ticks - static_cast<double>(skipped)));
      bucket.bodies.push_back(static_cast<std::uint64_t>(std::max<std::int64_t>(0, region.bodies)));
      bucket.skipped_ticks.push_back(skipped);
      bucket.longest_step_ms = std::max(bucket.longest_step_ms, region.frame_ms_max);
      if (!region.outside.empty()) ++bucket.servers_outside;
    }
    return bucket;
  }

  Status wait_until_linked() {
    const double until_s = now_s() + o_.start_limit_s;
    while (now_s() < until_s) {
      if (auto well = look(0.01); !well) return well.error();
      const auto status = ask();
      if (!status || !all_up(*status) || status->world_time_s <= 0) continue;
      world_time_s_ = status->world_time_s;
      return Ok{};
    }
    return Error::format("the servers were not linked within {:.0f} s", o_.start_limit_s);
  }

  /// Waits, and takes what the children say, so that none of them waits for a full pipe.
  Status look(double limit_s) {
    std::vector<pollfd> watched;
    for (const ChildProcess& child : children_)
      for (const Output which : {Output::standard, Output::error})
        watched.push_back({child.descriptor(which), POLLIN, 0});
    poll(watched.data(), watched.size(), std::max(1, static_cast<int>(limit_s * 1000)));
    for (std::size_t i = 0; i < children_.size(); ++i) {
      std::string last;
      for (const Output which : {Output::standard, Output::error})
        children_[i].read(which, [&](const std::string& line) { last = line; });
      if (!children_[i].is_running())
        return Error::format("{} ended ({}): {}", names_[i], children_[i].how_it_ended(), last);
    }
    return Ok{};
  }

  Result<WorldStatus> ask() const {
    const auto answer = http_get(status_url_, status_limit_ms);
    if (!answer) return answer.error();
    if (answer->status != 200) return Error::format("{} answers {}", status_url_, answer->status);
    return parse_world_status(answer->body);
  }

  /// Of the regions, which come before the gateway.
  Result<std::vector<std::int64_t>> cpu_ns() const {
    std::vector<std::int64_t> all;
    for (std::size_t r = 0; r < world_.regions.size(); ++r) {
      const auto spent = thread_cpu_of_process_ns(children_[r].pid());
      if (!spent) return spent.error();
      all.push_back(*spent);
    }
    return all;
  }

  const WorldDefinition& world_;
  const RealTimeOptions& o_;
  const std::function<void(const std::string&)>& progress_;
  std::unique_ptr<TemporaryFolder> folder_;
  std::vector<std::string> names_;
  std::vector<ChildProcess> children_;  ///< Killed at the end: none of them keeps anything.
  std::string status_url_;
  double world_time_s_ = 0;
  std::vector<std::int64_t> skipped_;  ///< By region, so far.
};

}  // namespace

Result<std::int64_t> thread_cpu_of_process_ns(int pid) {
  const std::string path = fmt::format("/proc/{}/task/{}/schedstat", pid, pid);
  std::ifstream file(path);
  std::int64_t spent_ns = -1;
  if (!(file >> spent_ns) || spent_ns < 0)
    return Error::format("{} does not say how long the process has run", path);
  return spent_ns;
}

Result<std::vector<RealTimeBucket>> run_in_real_time(
    const WorldDefinition& world, const RealTimeOptions& options,
    const std::function<void(const std::string&)>& progress) {
  RealWorld real(world, options, progress);
  if (auto started = real.start(); !started) return started.error();
  return real.measure();
}

nlohmann::json compare_with_virtual_time(const std::vector<RealTimeBucket>& real,
                                         const nlohmann::json& report, const nlohmann::json& cold) {
  nlohmann::json buckets = nlohmann::json::array();
  const std::size_t count =
      std::min({real.size(), report["buckets"].size(), cold["buckets"].size()});
  for (std::size_t b = 0; b < count; ++b) {
    const nlohmann::json& in_virtual_time = report["buckets"][b];
    const nlohmann::json& with_cold_caches = cold["buckets"][b];
    const double worst_ms = *std::max_element(real[b].server_ms.begin(), real[b].server_ms.end());
    const double virtual_ms = in_virtual_time["worst_server_ms"].get<double>();
    const double cold_ms = with_cold_caches["worst_server_ms"].get<double>();
    buckets.push_back({{"t_end_s", real[b].t_end_s},
                       {"worst_server_ms", worst_ms},
                       {"server_ms", real[b].server_ms},
                       {"bodies", real[b].bodies},
                       {"skipped_ticks", real[b].skipped_ticks},
                       {"longest_step_ms", real[b].longest_step_ms},
                       {"servers_outside", real[b].servers_outside},
                       {"virtual_worst_server_ms", virtual_ms},
                       {"virtual_server_ms", in_virtual_time["server_ms"]},
                       {"virtual_bodies", in_virtual_time["bodies"]},
                       {"cold_worst_server_ms", cold_ms},
                       {"cold_server_ms", with_cold_caches["server_ms"]},
                       {"ratio", worst_ms / virtual_ms},
                       {"ratio_cold", worst_ms / cold_ms}});
  }
  return {{"experiment", report["experiment"]}, {"buckets", std::move(buckets)}};
}

}  // namespace aureole
