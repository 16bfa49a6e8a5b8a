// Scene `replicas`: what a server tells gateways after each step.
#include "server/base/tick.h"
#include "server/bench/replica_bytes.h"
#include "server/bench/samples.h"
#include "server/bench/situations.h"
#include "server/region/replica_publisher.h"

namespace aureole {

std::vector<BenchRow> bench_replicas(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const auto make : {poured, settled, in_flight}) {
    const Situation situation = make(options);
    Samples updates(situation.name, "update after a step");
    Samples wholes(situation.name, "whole state for a new gateway");
    ReplicaBytes bytes;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      SituatedWorld world(situation);
      const PhysicsWorld& physics = world.physics();
      ReplicaPublisher publisher;
      for (BodyId id : physics.ids())
        publisher.body_gained(id, Version{1, Incarnation{1}, RegionId{0}});
      // Everybody's first state is no tick's usual work.
      publisher.update(Tick{0}, physics, {});
      for (int n = 1; n <= options.ticks; ++n) {
        world.physics().step(tick_s);
        SharedBytes frame;
        const double us = cpu_us_of([&] { frame = publisher.update(Tick{n}, physics, {}); });
        updates.add(us, {physics.size(), physics.awake_count(), frame->size()});
        bytes.add(*frame);
      }
      std::vector<SharedBytes> frames;
      const double us =
          cpu_us_of([&] { frames = publisher.whole_state(Tick{options.ticks}, physics, {}, {}); });
      std::size_t sum = 0;
      for (const SharedBytes& frame : frames) sum += frame->size();
      wholes.add(us, {physics.size(), physics.awake_count(), sum});
    }
    updates.note(bytes.note());
    rows.push_back(updates.row());
    rows.push_back(wholes.row());
  }
  return rows;
}

}  // namespace aureole
