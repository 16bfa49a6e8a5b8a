// What a region's decisions depend on: its boundary, and whoever is inside.
#include "server/region/view/boundary_strip.h"

#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

PartitionMap two_columns() {
  return PartitionMap({{-inf, -inf, 0, inf}, {0, -inf, inf, inf}});
}

RemoteAura visitor(double x, double z) {
  RemoteAura aura;
  aura.id = BodyId::world(1);
  aura.host = RegionId{1};
  aura.room = {{x, 1, z}, {0, 0, 0}, 1};
  return aura;
}

}  // namespace

TEST_CASE("a strip is as deep as it is said to be, and everything outside is in it") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0});
  strip.note({}, 12);
  CHECK(strip.holds({-11.9, 0, 500}));
  CHECK_FALSE(strip.holds({-12.1, 0, 0}));
  CHECK_FALSE(strip.holds({-9000, 0, 0}));
  CHECK(strip.holds({3, 0, 0}));
  CHECK(strip.holds({std::nan(""), 0, 0}));
}

TEST_CASE("what others have inside widens the strip around it, while they have it there") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0});
  const std::vector<RemoteAura> inside{visitor(-100, 40), visitor(-2, 0), visitor(-60, -40)};
  strip.note(inside, 12);
  for (const double off : {-12.9, 0.0, 12.9}) {
    CHECK(strip.holds({-100 + off, 0, 40}));
    CHECK(strip.holds({-60, 0, -40 + off}));
  }
  CHECK_FALSE(strip.holds({-100, 0, -40}));
  CHECK_FALSE(strip.holds({-150, 0, 40}));
  strip.note({}, 12);
  CHECK_FALSE(strip.holds({-100, 0, 40}));
}

TEST_CASE("visitors too far apart to be told from each other make everything count") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0});
  strip.note(std::vector<RemoteAura>{visitor(-1e6, 0), visitor(-100, 0)}, 12);
  CHECK(strip.holds({-5000, 0, 0}));
}

TEST_CASE("a region without a boundary has no strip; a policy that wants everything gets it") {
  const PartitionMap one({{-inf, -inf, inf, inf}});
  BoundaryStrip none(one, RegionId{0});
  none.note({}, 12);
  CHECK_FALSE(none.holds({0, 0, 0}));
  const PartitionMap map = two_columns();
  BoundaryStrip all(map, RegionId{0});
  all.note({}, inf);
  CHECK(all.holds({-5000, 0, 0}));
  CHECK(all.shows({{-5000, 0, 0}, {1, 1, 1}}));
}

TEST_CASE("a strip shows a room if it holds all of it") {
  const PartitionMap map = two_columns();
  BoundaryStrip strip(map, RegionId{0});
  const auto shows = [&](double x, double z, double half) {
    return strip.shows({{x, 1, z}, {half, 1, half}});
  };
  strip.note({}, 12);
  CHECK(shows(-6, 0, 5.9));
  CHECK_FALSE(shows(-6, 0, 6.1));
  CHECK(shows(50, 0, 49));
  const std::vector<RemoteAura> inside{visitor(-100, 40)};
  strip.note(inside, 12);
  CHECK(shows(-100, 40, 12));
  CHECK_FALSE(shows(-100, 40, 22));
  CHECK_FALSE(shows(-60, 0, 59));
  CHECK_FALSE(shows(-1e9, 0, 1e9));
  strip.note({}, 6);
  CHECK_FALSE(shows(-6, 0, 5.9));
}
