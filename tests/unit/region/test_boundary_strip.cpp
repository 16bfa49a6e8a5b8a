// What a region's decisions depend on: its boundary, and whoever is inside.
#include "server/region/boundary_strip.h"

#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

PartitionMap two_columns() {
  return PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, inf, inf}});
}

RemoteAura visitor(double x, double z) {
  return {BodyId::world(1), RegionId{1}, {{x, 1, z}, {0, 0, 0}, 1}};
}

}  // namespace

TEST_CASE("a strip is as deep as it is said to be, and everything outside is in it") {
  const PartitionMap map = two_columns();
  const BoundaryStrip strip(map, RegionId{0}, 12);
  CHECK(strip.holds({-11.9, 0, 500}));
  CHECK_FALSE(strip.holds({-12.1, 0, 0}));
  CHECK_FALSE(strip.holds({-9000, 0, 0}));
  CHECK(strip.holds({3, 0, 0}));
  CHECK(strip.holds({std::nan(""), 0, 0}));
}

TEST_CASE("what others have inside widens the strip around it, while they have it there") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0}, 12);
  const std::vector<RemoteAura> inside{visitor(-100, 40), visitor(-2, 0), visitor(-60, -40)};
  strip.note(inside);
  for (const double off : {-12.9, 0.0, 12.9}) {
    CHECK(strip.holds({-100 + off, 0, 40}));
    CHECK(strip.holds({-60, 0, -40 + off}));
  }
  CHECK_FALSE(strip.holds({-100, 0, -40}));
  CHECK_FALSE(strip.holds({-150, 0, 40}));
  strip.note({});
  CHECK_FALSE(strip.holds({-100, 0, 40}));
}

TEST_CASE("visitors too far apart to be told from each other make everything count") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0}, 12);
  strip.note(std::vector<RemoteAura>{visitor(-1e6, 0), visitor(-100, 0)});
  CHECK(strip.holds({-5000, 0, 0}));
}

TEST_CASE("a region without a boundary has no strip; a policy that wants everything gets it") {
  const PartitionMap one({{-inf, -inf, inf, inf}});
  CHECK_FALSE(BoundaryStrip(one, RegionId{0}, 12).holds({0, 0, 0}));
  const PartitionMap map = two_columns();
  CHECK(BoundaryStrip(map, RegionId{0}, inf).holds({-5000, 0, 0}));
}
