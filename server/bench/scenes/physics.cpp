// Scene `physics`: what Bullet's step takes.
#include "server/base/tick.h"
#include "server/bench/samples.h"
#include "server/bench/situations.h"

namespace aureole {

std::vector<BenchRow> bench_physics(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const auto make : {poured, settled, in_flight}) {
    const Situation situation = make(options);
    Samples steps(situation.name, "step");
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      SituatedWorld world(situation);
      PhysicsWorld& physics = world.physics();
      for (int n = 0; n < options.ticks; ++n) {
        const double us = cpu_us_of([&] { physics.step(tick_s); });
        steps.add(us, {physics.size(), physics.awake_count(), 0});
      }
    }
    rows.push_back(steps.row());
  }
  return rows;
}

}  // namespace aureole
