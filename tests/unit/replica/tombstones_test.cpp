// Remembering removals without growing for ever.
#include "server/replica/tombstones.h"

#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

TEST_CASE("A tombstone covers its own version and all lower ones") {
  Tombstones tombstones;
  CHECK_FALSE(tombstones.covers(ball, version_of(r0, 1)));
  tombstones.remember(ball, version_of(r0, 2));
  CHECK(tombstones.covers(ball, version_of(r0, 1)));
  CHECK(tombstones.covers(ball, version_of(r0, 2)));
  CHECK_FALSE(tombstones.covers(ball, version_of(r1, 2)));
  CHECK_FALSE(tombstones.covers(box, version_of(r0, 1)));
}

TEST_CASE("The highest version that was removed counts, whichever was heard last") {
  Tombstones tombstones;
  tombstones.remember(ball, version_of(r0, 5));
  tombstones.remember(ball, version_of(r0, 2));
  CHECK(tombstones.covers(ball, version_of(r0, 5)));
  CHECK(tombstones.size() == 1);
}

TEST_CASE("The oldest removals are forgotten first") {
  Tombstones tombstones(100);
  for (std::uint32_t n = 0; n < 150; ++n) tombstones.remember(BodyId::world(n), version_of(r0, 1));
  CHECK(tombstones.size() == 100);
  CHECK_FALSE(tombstones.covers(BodyId::world(49), version_of(r0, 1)));
  CHECK(tombstones.covers(BodyId::world(50), version_of(r0, 1)));
  CHECK(tombstones.covers(BodyId::world(149), version_of(r0, 1)));
}

TEST_CASE("A body that is removed again and again takes one place and counts as new") {
  Tombstones tombstones(10);
  tombstones.remember(ball, version_of(r0, 1));
  for (std::uint32_t n = 0; n < 6; ++n)
    tombstones.remember(BodyId::world(100 + n), version_of(r0, 1));
  tombstones.remember(ball, version_of(r0, 2));
  CHECK(tombstones.size() == 7);
  for (std::uint32_t n = 0; n < 9; ++n)
    tombstones.remember(BodyId::world(200 + n), version_of(r0, 1));
  CHECK(tombstones.covers(ball, version_of(r0, 2)));
  tombstones.remember(BodyId::world(300), version_of(r0, 1));
  CHECK_FALSE(tombstones.covers(ball, version_of(r0, 2)));
  CHECK(tombstones.size() == 10);
}
