// What a body can touch: rooms of rest, flight and blows against what really moves.
#include "server/aura/adaptive/outlook/aura_size.h"

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

TEST_CASE("the reach time: until the next decision, then the arbiter hears of it, asks and gets") {
  CHECK(reach_ticks(AuraTolerances{}) == 1 + 2 + 2 + 2 + spare_ticks);
  CHECK(reach_time_s(AuraTolerances{}) == Approx(0.128));
  // What takes three steps is heard at the next decision after them, or comes with the third.
  const AuraTolerances slower{32, 10, 15};
  REQUIRE(steps_in_flight(slower) == 3);
  CHECK(reach_ticks(slower) == 1 + 4 + 4 + 3 + spare_ticks);
}

TEST_CASE("a blast is told of a flight before the reach time begins, in which nobody is refused") {
  CHECK(blast_lead_ticks(AuraTolerances{}) == 2 + 1 + 2 + 2 + 2);
  CHECK(blast_lead_ticks({32, 10, 15}) == 3 + 1 + 4 + 4 + 3);
}

TEST_CASE("whoever comes near is told of before the fastest body has come") {
  // One tick until the next decision, two until it is heard there.
  CHECK(visitor_clearance_m(AuraTolerances{}) == Approx(32 * 3 * 0.016));
}

TEST_CASE("what lies on level ground sinks no further, what may fall over reaches as it falls") {
  HostedBody plank;
  plank.bounding_radius_m = 1;
  plank.girth_m = 0.2;
  plank.lowest_m = 0.15;
  plank.ground_gap_m = 0;
  const auto reach = [&](double half_height_m, double gap_m) {
    plank.half_extents = {0.5, half_height_m, 0.5};
    plank.ground_gap_m = gap_m;
    const AuraCapsule lies = resting_aura(plank);
    return struck_aura(plank, lies, 0, reach_s).girth_m - lies.girth_m;
  };
  const double falls_m = 0.5 * gravity_mps2 * reach_s * reach_s;
  CHECK(reach(0.15, 0) == 0);
  CHECK(reach(0.5, 0) == Approx(falls_m));
  CHECK(reach(0.15, std::numeric_limits<double>::infinity()) == Approx(falls_m));
  // It comes down by a little, and goes on as fast as it has become, in whatever direction.
  for (const double drop : {0.001, 0.01, 0.03, 0.06}) {
    double speed = 0, way = 0;
    for (double t = 0; t < reach_s; t += 1e-5) {
      if (way < drop) speed += gravity_mps2 * 1e-5;
      way += speed * 1e-5;
    }
    INFO(drop << " m");
    CHECK(reach(0.15 + drop, 0) == Approx(way).epsilon(0.01));
    CHECK(reach(0.15, drop) == Approx(way).epsilon(0.01));
  }
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
  CHECK(holds(struck_aura(high, room, 20 * reach_s, reach_s), {2.5, 10, 0}, 0.3));
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
