// A region whose neighbour says what a test puts into its mouth.
#pragma once

#include <optional>

#include "tests/support/region_cluster.h"

namespace aureole::testing {

struct Besieged {
  WorldDefinition world = flat_world(2);
  std::optional<RegionCore> core;
  std::uint64_t sequence = 0;
  Tick now;

  void start() {
    core.emplace(world, RegionId{0}, Incarnation{1});
    core->peer_up(PeerId{1}, Incarnation{1});
    core->peer_up(PeerId::gateway(0), Incarnation{1});
  }
  Status hear(FrameType type, Bytes payload) {
    return core->receive(PeerId{1}, Frame{type, ++sequence, std::move(payload)});
  }
  Status hand_over(BodyId id, PrototypeId prototype, const BodyState& state, Tick tick,
                   std::uint32_t epoch = 1) {
    HandoffGroup group;
    group.tick = tick;
    group.bodies.push_back({{id, prototype, state}, epoch});
    return hear(FrameType::handoff, encode_handoff(group));
  }
  void step(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) core->step(now = now + 1);
  }
};

inline BodyState at(WorldPosition position) {
  BodyState state;
  state.position = position;
  return state;
}

}  // namespace aureole::testing
