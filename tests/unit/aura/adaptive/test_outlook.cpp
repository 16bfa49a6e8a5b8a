// What a body that strikes something may touch, against what can really become of it.
#include "server/aura/adaptive/outlook/outlook.h"

#include "server/aura/adaptive/outlook/aura_size.h"
#include "tests/unit/aura/adaptive/adaptive_scene.h"
#include "tests/unit/aura/aura_maps.h"

using namespace aureole;
using namespace aureole::adaptive_scene;

namespace {

const double reach_s = reach_time_s(AuraTolerances{});

/// A ball on level ground that rolls in x.
HostedBody rolling(double speed) {
  HostedBody body = awake_at(0, 15);
  body.position.y = 0.3;
  body.round = true;
  body.ground_gap_m = 0;
  body.lowest_m = 0.3;
  body.velocity_mps = {speed, 0, 0};
  body.motion_speed_mps = speed;
  return body;
}

AuraCapsule aura_beside(const HostedBody& striking, double gap_m) {
  Scene scene;
  HostedBody struck = asleep_at(1, striking.position.x + 0.6 + gap_m);
  struck.position.y = 0.3;
  scene.hosted = {striking, struck};
  Outlook outlook(reach_s);
  outlook.look({Tick{0}, RegionId{0}, scene.map, scene.hosted, {}, {}, scene.linked});
  return outlook.aura(0);
}

bool holds(const AuraCapsule& room, const Eigen::Vector3d& centre, double radius_m) {
  return gap_m(room, {centre, {0, 0, 0}, 0}) <= -radius_m;
}

}  // namespace

TEST_CASE("a ball that strikes something may go anywhere from there, as fast as it came") {
  for (const double speed : {0.5, 3.0, 10.0, 30.0})
    for (const double gap : {0.0, 0.1, 0.3, 1.0}) {
      const HostedBody ball = rolling(speed);
      const AuraCapsule room = aura_beside(ball, gap);
      const double alone_s = gap / speed;
      for (double t = 0; t <= reach_s; t += 0.004)
        for (int k = 0; k < 16; ++k) {
          const double angle = k * 3.14159265 / 8;
          const double straight_s = std::min(t, alone_s);
          Eigen::Vector3d at = ball.position.vector() + straight_s * ball.velocity_mps;
          at += (t - straight_s) * speed * Eigen::Vector3d(std::cos(angle), 0, std::sin(angle));
          INFO(speed << " m/s, gap " << gap << " m, after " << t << " s at " << at.transpose());
          REQUIRE(holds(room, at, 0.3));
        }
    }
}

TEST_CASE("where three regions meet what is slow does not look ahead a tick to spare") {
  const auto reach_m = [](double speed, const PartitionMap& map) {
    Scene scene;
    scene.map = map;
    scene.hosted = {rolling(speed)};
    Outlook outlook(reach_s);
    outlook.look({Tick{0}, RegionId{0}, scene.map, scene.hosted, {}, {}, scene.linked});
    const AuraBox box = outlook.box(0);
    return box.centre.x() + box.half.x();
  };
  const double tick_m = tick_us / 1e6 * spare_ticks;
  const double slow = 0.9 * spare_from_mps, fast = 1.1 * spare_from_mps;
  CHECK(reach_m(slow, columns(3)) - reach_m(slow, aura_maps::quarters()) > 0.9 * slow * tick_m);
  CHECK(reach_m(fast, columns(3)) == reach_m(fast, aura_maps::quarters()));
}

TEST_CASE("what is overtaken goes on faster than it was and faster than the blow alone would be") {
  // 1 kg at 30 m/s from behind onto 10 kg at 3.3 m/s: they go on at (30 + 33) / 11 m/s.
  Scene scene;
  HostedBody slow = rolling(3.3), fast = rolling(30);
  slow.mass_kg = 10;
  fast.id = name(1);
  fast.position.x -= 0.6;
  scene.hosted = {slow, fast};
  Outlook outlook(reach_s);
  outlook.look({Tick{0}, RegionId{0}, scene.map, scene.hosted, {}, {}, scene.linked});
  CHECK(holds(outlook.aura(0), {15 + 63.0 / 11 * reach_s, 0.3, 0}, 0.3));
}

TEST_CASE("what strikes at once does not reach as far as its way and then as far again") {
  const double speed = 10;
  const AuraBox room = aura_beside(rolling(speed), 0).box();
  CHECK(room.centre.x() + room.half.x() < 15 + 0.3 + 1.3 * speed * reach_s);
  CHECK(room.half.z() < 0.3 + 1.3 * speed * reach_s);
  // With nothing in its way it goes on.
  const AuraBox alone = aura_beside(rolling(speed), 5).box();
  CHECK(alone.half.z() < 0.5);
}
