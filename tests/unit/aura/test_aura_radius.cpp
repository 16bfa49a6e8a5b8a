// Equations (1) to (4) against the worked constants of the paper.
#include "server/aura/aura_radius.h"
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
