// What regions say of players: the avatar's owner is believed, the newest session counts.
#include "server/replica/replica_store.h"
#include "tests/support/catch.h"
#include "tests/unit/replica/update.h"

using namespace aureole;
using namespace aureole::test;

namespace {
constexpr PlayerId anna{7};
Key avatar_of(RegionId owner, std::uint32_t epoch) {
  return {.id = BodyId::avatar(anna), .version = version_of(owner, epoch)};
}
struct Fixture {
  ReplicaStore store{1};
  Fixture() {
    for (RegionId r : {r0, r1}) store.region_up(r);
  }
  void hear(RegionId from, const Update& update) { REQUIRE(store.apply(from, update.bytes())); }
};
}  // namespace

TEST_CASE("A player is known from the owner of the avatar") {
  Fixture f;
  f.hear(r0, Update(1).key(avatar_of(r0, 1)).player(7, 3, 12, ball));
  const auto player = f.store.player(anna);
  REQUIRE(player);
  CHECK(player->player == anna);
  CHECK(player->owner == r0);
  CHECK(player->session == 3);
  CHECK(player->applied_sequence == 12);
  CHECK(player->connected);
  CHECK(player->carried == ball);
  CHECK_FALSE(f.store.player(PlayerId{8}));
}

TEST_CASE("A region that does not own the avatar has no say in its player, before or after") {
  Fixture f;
  f.hear(r0, Update(1).player(7, 3, 12));
  CHECK_FALSE(f.store.player(anna));
  f.hear(r0, Update(2).key(avatar_of(r0, 1)).player(7, 3, 12));
  f.hear(r1, Update(2).player(7, 9, 99));
  CHECK(f.store.player(anna)->session == 3);
  f.hear(r1, Update(3).key(avatar_of(r1, 2)).player(7, 3, 14));
  f.hear(r0, Update(3).player(7, 3, 13));
  CHECK(f.store.player(anna)->owner == r1);
  CHECK(f.store.player(anna)->applied_sequence == 14);
}

TEST_CASE("The newest session of a player counts, an older one is not taken") {
  Fixture f;
  f.hear(r0, Update(1).key(avatar_of(r0, 1)).player(7, 3, 12));
  f.hear(r0, Update(2).player(7, 4, 1));
  CHECK(f.store.player(anna)->session == 4);
  CHECK(f.store.player(anna)->applied_sequence == 1);
  f.hear(r0, Update(3).player(7, 3, 13));
  CHECK(f.store.player(anna)->session == 4);
  CHECK(f.store.player(anna)->applied_sequence == 1);
}

TEST_CASE("A player goes with the avatar") {
  Fixture f;
  f.hear(r0, Update(1).key(avatar_of(r0, 1)).player(7, 3, 12));
  f.hear(r0, Update(2).removed(BodyId::avatar(anna), version_of(r0, 1)));
  CHECK_FALSE(f.store.player(anna));
  f.hear(r0, Update(3).player(7, 3, 12));
  CHECK_FALSE(f.store.player(anna));
}
