// What a body can touch: rooms of rest, flight and blows against what really moves.
#include "server/aura/adaptive/aura_size.h"

#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double reach_s = 0.128;

HostedBody ball(double y, const Eigen::Vector3d& velocity) {
  HostedBody body;
  body.position = {0, y, 0};
  body.half_extents = {0.3, 0.3, 0.3};
  body.bounding_radius_m = body.girth_m = 0.3;
  body.velocity_mps = velocity;
  body.motion_speed_mps = velocity.norm();
  body.round = true;
  body.ground_gap_m = std::max(0.0, y - 0.3);
  return body;
}

bool holds(const AuraCapsule& room, const Eigen::Vector3d& centre, double radius_m) {
  return gap_m(room, {centre, {0, 0, 0}, 0}) <= -radius_m;
}

}  // namespace

TEST_CASE("the reach time is four flights: the arbiter hears of it, decides, asks and gets") {
  CHECK(reach_time_s(AuraTolerances{}) == Approx(0.128));
}

TEST_CASE("a ball in flight stays in its room as far as it flies, falls, lands and rolls on") {
  for (const double y : {0.3, 0.6, 1.0, 5.0})
    for (const double vx : {0.0, 3.0, 20.0})
      for (const double vy : {-20.0, -3.0, 0.0, 4.0}) {
        const HostedBody body = ball(y, {vx, vy, 0});
        const AuraCapsule room = flight_aura(body, reach_s);
        Eigen::Vector3d at = body.position.vector(), velocity = body.velocity_mps;
        for (double t = 0; t <= reach_s; t += 0.001) {
          INFO(y << " m high, " << vx << ", " << vy << " m/s, after " << t << " s");
          REQUIRE(holds(room, at, 0.3));
          velocity.y() -= gravity_mps2 * 0.001;
          at += 0.001 * velocity;
          if (at.y() >= 0.3) continue;
          at.y() = 0.3;
          velocity.x() += 0.5 * std::abs(velocity.y());  // Turned aside by friction, at worst.
          velocity.y() = 0;
        }
      }
}

TEST_CASE("a fast ball in flight reaches along its way and hardly beside it") {
  const HostedBody body = ball(10, {0, -20, 0});
  HostedBody high = body;
  high.ground_gap_m = std::numeric_limits<double>::infinity();
  const AuraCapsule room = flight_aura(high, reach_s);
  CHECK(room.box().half.x() < 0.6);
  CHECK(holds(room, {0, 10 - 2.5, 0}, 0.3));
  CHECK(holds(struck_aura(room, 20 * reach_s, reach_s), {2.5, 10, 0}, 0.3));
}

TEST_CASE("a ball that drops onto the ground does not reach as far aside as it falls fast") {
  const AuraCapsule room = flight_aura(ball(1.5, {0, -15, 0}), reach_s);
  CHECK(room.box().half.x() < 1.2);
  CHECK(holds(room, {0, 0.3, 0}, 0.3));
}

TEST_CASE("a rolling ball needs no more room than its centre moves") {
  HostedBody body = ball(0.3, {3, 0, 0});
  body.motion_speed_mps = 3.55;  // With what its spin may become.
  const AuraBox box = flight_aura(body, reach_s).box();
  CHECK(box.half.x() < 0.3 + 3 * reach_s);
  CHECK(box.half.z() < 0.55);
}
