// Equations (1) to (4) against the worked constants of the paper.
#include <cmath>

#include "server/aura/shapes/aura_radius.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("the paper's tolerances give 80 ms and 2.56 m") {
  const AuraTolerances paper{32.0, 2.0, 15.0};
  REQUIRE(steps_in_flight(paper) == 2);
  REQUIRE(remote_displacement_s(paper) == Approx(0.032));
  REQUIRE(host_displacement_s(paper) == Approx(0.048));
  REQUIRE(total_displacement_s(paper) == Approx(0.080));
  REQUIRE(aura_radius_m(1.0, paper) == Approx(3.56));
}

TEST_CASE("equation (3) is the sum of equations (1) and (2) for every tolerance") {
  for (double latency = 0; latency < 100; latency += 0.7)
    for (double frame = 1; frame < 40; frame += 1.3) {
      const AuraTolerances t{10, latency, frame};
      REQUIRE(total_displacement_s(t) == Approx(remote_displacement_s(t) + host_displacement_s(t)));
    }
}

TEST_CASE("one microsecond past a whole number of steps costs a whole step more") {
  REQUIRE(steps_in_flight({32, 2.0, 15.0}) == 2);
  REQUIRE(steps_in_flight({32, 2.001, 15.0}) == 3);
}

TEST_CASE(
    "the paper's bodies have the auras of its tolerances: 2.56 m more than their own sphere") {
  const AuraTolerances paper;
  REQUIRE(paper.speed_mps * total_displacement_s(paper) == Approx(2.56));
  REQUIRE(aura_radius_m(0.3, paper) == Approx(2.86));  // The sphere.
  REQUIRE(aura_radius_m(std::hypot(0.15, 0.15, 0.5), paper) ==
          Approx(2.56 + 0.54314).epsilon(1e-5));
  REQUIRE(aura_radius_m(1.0, paper) == Approx(3.56));  // The capsule, 2 m high with its caps.
}

TEST_CASE("tolerances that add up to whole steps take no step more, whatever their fractions") {
  for (int frame_us = 100; frame_us < 16'000; frame_us += 100)
    for (int steps = 1; steps <= 4; ++steps) {
      const int latency_us = steps * 16'000 - 2 * frame_us;
      if (latency_us < 0) continue;
      REQUIRE(steps_in_flight({32, latency_us / 1000.0, frame_us / 1000.0}) == steps);
    }
}

TEST_CASE("a slower world needs smaller auras, a slower network larger ones") {
  REQUIRE(aura_radius_m(0.5, {8, 2, 15}) == Approx(0.5 + 0.64));
  REQUIRE(aura_radius_m(0.5, {32, 20, 15}) == Approx(0.5 + 32 * 11 * 0.016));
  REQUIRE(remote_displacement_s({32, 0, 8}) == Approx(0.016));
  REQUIRE(host_displacement_s({32, 0, 8}) == Approx(0.016));
}
