// A player whose avatar comes from another server: what was held back there is held back here.
#include <algorithm>
#include <cmath>

#include "server/aura/adaptive/outlook/aura_size.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr PlayerId me{40};
constexpr Tick arrival{1000};

/// A region to which its neighbour hands the avatar of a player.
struct Arrival {
  WorldDefinition world = flat_world(2);
  RegionCore core{world, RegionId{0}, Incarnation{1}};
  Tick now = arrival;
  Avatar avatar;

  Arrival() {
    core.peer_up(PeerId{1}, Incarnation{1});
    core.peer_up(PeerId::gateway(0), Incarnation{1});
    avatar.player = me;
    avatar.session = 1;
    avatar.active = arrival + -1000;
  }

  PlayerCommand throws(std::uint32_t sequence) const {
    PlayerCommand command;
    command.player = me;
    command.session = 1;
    command.sequence = sequence;
    command.kind = Kind::throw_body;
    return command;
  }
  /// In the next step it is here.
  void hand_over() {
    BodyState state;
    state.position = {30, 0.9, 0};
    HandoffGroup group;
    group.tick = now;
    group.bodies.push_back({{avatar.body(), avatar_prototype, state}, 1});
    group.avatars.push_back(avatar);
    REQUIRE(core.receive(PeerId{1}, Frame{FrameType::handoff, 1, encode_handoff(group)}));
  }
  void command(std::uint32_t sequence) {
    const PlayerCommand command = throws(sequence);
    REQUIRE(core.receive(PeerId::gateway(0),
                         Frame{FrameType::commands, 0, encode_commands(std::span(&command, 1))}));
  }
  /// How many steps pass until it has thrown, the one in which it does left out.
  int steps_until_thrown() {
    for (int steps = 0; steps < 100; ++steps) {
      core.step(now = now + 1);
      if (core.physics().contains(BodyId::thrown(me, 0))) return steps;
    }
    return -1;
  }
  /// Until a grown aura has been heard of and what it meets is here.
  int reach_ticks() const {
    return static_cast<int>(std::llround(reach_time_s(world.tolerances) / tick_s));
  }
};

}  // namespace

TEST_CASE("an idle player who has just come throws only when those near have heard") {
  Arrival arrives;
  arrives.hand_over();
  arrives.command(1);
  CHECK(arrives.steps_until_thrown() == arrives.reach_ticks());
}

TEST_CASE("a player in play who has just come throws at once") {
  Arrival arrives;
  arrives.avatar.active = arrival + -10;
  arrives.hand_over();
  arrives.command(1);
  CHECK(arrives.steps_until_thrown() == 0);
}

TEST_CASE("what a player's server held back waits as long at the next one, and no longer") {
  for (const int ticks : {3, 1000}) {
    Arrival arrives;
    // It had done nothing for long, then it threw, and left.
    arrives.avatar.active = arrival;
    arrives.avatar.held_until = arrival + ticks;
    arrives.avatar.waiting.emplace(1, arrives.throws(1));
    arrives.hand_over();
    INFO("held for " << ticks << " ticks");
    CHECK(arrives.steps_until_thrown() == std::min(ticks - 1, arrives.reach_ticks()));
  }
}
