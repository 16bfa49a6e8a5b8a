// A body that is not where it would have been without its handoff is noticed, to the millimetre.
#include "server/experiment/oracles/handoff_shadow.h"
#include "server/experiment/scenario/scenario.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("the shadow of a handoff knows where the body would have been") {
  WorldDefinition before = layout_world("column4");
  const BodyId ball = put_body(before, sphere_prototype, {-33, 5, 0}, {4, 0, 0});
  WorldDefinition moved = before;
  moved.bodies[0].state.position.x += 0.1;
  for (const bool jumps : {false, true}) {
    // The sender steps to tick 3 and lets go; the receiver has it at tick 5, on the same path or on
    // one that is 100 mm off.
    before.bodies[0].host = RegionId{0};
    moved.bodies[0].host = RegionId{1};
    WorldDefinition same = before;
    same.bodies[0].host = RegionId{1};
    RegionCore sender(before, RegionId{0}, Incarnation{1});
    for (int t = 1; t <= 3; ++t) sender.step(Tick{t});
    HandoffShadow shadow(before);
    HandoffGroup group;
    group.tick = Tick{3};
    group.bodies.push_back({{ball, sphere_prototype, sender.physics().state(ball)}, 1, 0});
    const std::vector<Departure> departures{{RegionId{0}, RegionId{1}, group}};
    shadow.left(sender, Tick{3}, departures, false);
    RegionCore receiver(jumps ? moved : same, RegionId{1}, Incarnation{1});
    for (int t = 1; t <= 5; ++t) receiver.step(Tick{t});
    shadow.stepped(RegionId{1}, Tick{5}, receiver, false);
    REQUIRE(shadow.jumps_mm().size() == 1);
    REQUIRE(shadow.jumps().front().body == ball);
    REQUIRE(shadow.p99()->to == RegionId{1});
    REQUIRE(shadow.jumps_mm().front() == Approx(jumps ? 100 : 0).margin(0.01));
  }
}
