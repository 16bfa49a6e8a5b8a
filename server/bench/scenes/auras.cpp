// Scene `auras`: whole frames of servers that talk, by their parts.
#include <array>

#include "server/bench/running_servers.h"
#include "server/bench/samples.h"

namespace aureole {

std::vector<BenchRow> bench_auras(const BenchOptions& options) {
  constexpr std::array<const char*, StepProfile::parts> parts{"physics", "aura", "decide", "wire"};
  std::vector<Samples> samples;
  for (const char* part : parts) samples.emplace_back("workload", part);
  samples.emplace_back("workload", "whole frame");
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    RunningServers servers(options);
    servers.run(options.seconds);
    for (int n = 0; n < options.ticks; ++n) {
      servers.tick();
      for (int r = 0; r < servers.count(); ++r) {
        const PhysicsWorld& physics = servers.core(r).physics();
        const Samples::Size size{physics.size(), physics.awake_count(), 0};
        const FrameTime frame = frame_time(*servers.profile(r));
        for (std::size_t part = 0; part < frame.size(); ++part)
          samples[part].add(frame[part] * 1e3, size);
        samples.back().add(total_ms(frame) * 1e3, size);
      }
    }
  }
  std::vector<BenchRow> rows;
  for (Samples& one : samples) rows.push_back(one.row());
  return rows;
}

}  // namespace aureole
