// Steps of tests in which a region recovers.
#pragma once

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

namespace aureole::testing {

/// Long enough for a recovery whose neighbours are all there.
inline void step_until_recovered(RegionCluster& cluster, int ticks_max = 400) {
  for (int n = 0; n < ticks_max && cluster.recovering(); ++n) cluster.step();
  REQUIRE_FALSE(cluster.recovering());
}

}  // namespace aureole::testing
