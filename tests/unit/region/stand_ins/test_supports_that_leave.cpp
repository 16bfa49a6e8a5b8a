// Supports that their server hands away, moves or removes, and who slept on them (adaptive mode).
#include "server/region/hosting.h"

#include "tests/support/acting_player.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr auto asleep = Activation::asleep;

/// One server's bodies: a box that sleeps on another one, or so far above it.
struct Pile {
  WorldDefinition world = flat_world(2);
  Hosting hosting{world, RegionId{0}, Incarnation{1}};
  const BodyId support = BodyId::world(0), on_top = BodyId::world(1);
  Tick now{300};

  explicit Pile(double gap_m = 0) {
    NewBody boxes[] = {{support, box, {}}, {on_top, box, {}}};
    boxes[0].state.position = {50.2, 0.5, 0};
    boxes[1].state.position = {49.95, 1.5 + gap_m, 0};
    if (gap_m > 0) boxes[0].state.activation = boxes[1].state.activation = asleep;
    hosting.spawn(boxes);
    for (int i = 0; i < 200; ++i) hosting.physics().step(tick_s);
    REQUIRE(hosting.physics().awake_count() == 0);
  }
  /// What decisions see of the two.
  void look(double support_mps) {
    hosting.begin_look(now);
    for (const BodyId id : {support, on_top}) {
      HostedBody seen;
      seen.id = id;
      seen.motion_speed_mps = id == support ? support_mps : 0;
      seen.asleep = seen.motion_speed_mps <= 0;
      hosting.look(seen, now, 0);
    }
  }
};

}  // namespace

TEST_CASE(
    "a resting support that is handed away stays as a stand-in, and who sleeps on it sleeps") {
  Pile pile;
  pile.look(0);
  const auto released = pile.hosting.release({&pile.support, 1}, pile.now, Hosting::Cut::at_rest);
  CHECK(released.left_behind == std::vector{pile.support});
  const PhysicsWorld& physics = pile.hosting.physics();
  CHECK(physics.is_stand_in(pile.support));
  CHECK(physics.is_asleep(pile.on_top));
  CHECK(physics.touching(pile.on_top) == std::vector{pile.support});
  for (int i = 0; i < 100; ++i) pile.hosting.physics().step(tick_s);
  CHECK(physics.position(pile.on_top).y == Approx(1.5).margin(2e-3));
}

TEST_CASE("what rests and is handed away stays as a stand-in for what is about to lean on it") {
  Pile pile(0.03);
  REQUIRE(pile.hosting.physics().touching(pile.on_top).empty());
  pile.look(0);
  const auto released = pile.hosting.release({&pile.support, 1}, pile.now, Hosting::Cut::at_rest);
  CHECK(released.left_behind == std::vector{pile.support});
  PhysicsWorld& physics = pile.hosting.physics();
  physics.wake(pile.on_top);
  for (int i = 0; i < 100; ++i) physics.step(tick_s);
  CHECK(physics.position(pile.on_top).y == Approx(1.5).margin(2e-3));
}

TEST_CASE("what rests and is handed away leaves nothing behind where nobody is beside it") {
  Pile pile(0.1);
  pile.look(0);
  const auto released = pile.hosting.release({&pile.support, 1}, pile.now, Hosting::Cut::at_rest);
  CHECK(released.left_behind.empty());
}

TEST_CASE("a support that moves is handed away without a stand-in, and who slept on it wakes") {
  Pile pile;
  pile.look(1);
  const auto released = pile.hosting.release({&pile.support, 1}, pile.now, Hosting::Cut::at_rest);
  CHECK(released.left_behind.empty());
  const PhysicsWorld& physics = pile.hosting.physics();
  CHECK_FALSE(physics.is_stand_in(pile.support));
  CHECK_FALSE(physics.is_asleep(pile.on_top));
  for (int i = 0; i < 60; ++i) pile.hosting.physics().step(tick_s);
  CHECK(physics.position(pile.on_top).y < 0.6);
}

TEST_CASE("what sleeps on a neighbour's body falls when that is removed from the world") {
  constexpr float west = 1.5708f, east = -1.5708f;
  for (const int delay : {0, 1}) {
    auto world = flat_world(2);
    // Whoever throws lays a box down 1.37 m ahead.
    for (auto& item : world.throwables) item = {"box", box, 0};
    world.spawn_points = {{{50.616, 0.95, 0}, west}, {{47.554, 0.95, 0}, east}};
    RegionCluster cluster(world, delay);
    constexpr PlayerId them{40}, me{48};
    ActingPlayer there(cluster, them, west), here(cluster, me, east);
    there.act(Kind::join, 1, 0);
    here.act(Kind::join, 0, 1);
    cluster.step(30);
    there.act(Kind::throw_body);
    cluster.step(100);
    here.act(Kind::throw_body);
    const BodyId support = BodyId::thrown(them, 0), on_top = BodyId::thrown(me, 0);
    cluster.step(400);
    INFO("delay " << delay);
    REQUIRE(cluster.owner(support) == 1);
    REQUIRE(cluster.owner(on_top) == 0);
    REQUIRE(cluster.state(on_top).activation == asleep);
    const WorldPosition before = cluster.state(on_top).position;
    REQUIRE(before.y == Approx(1.5).margin(0.02));
    cluster.step(100);
    CHECK(distance(cluster.state(on_top).position, before) < 1e-3);

    there.act(Kind::leave);
    // What an idle player does is held back for 8 ticks.
    cluster.step(11 + 2 * delay);
    REQUIRE_FALSE(cluster.owner(support));
    CHECK(cluster.state(on_top).activation == Activation::awake);
    cluster.step(80);
    CHECK(cluster.state(on_top).position.y < 0.6);
    CHECK(cluster.core(0).physics().stand_in_ids().empty());
    CHECK(cluster.core(0).statistics().struck_stand_ins == 0);
  }
}

TEST_CASE("what sleeps on a neighbour's body falls when a player carries that away") {
  constexpr float west = 1.5708f;
  for (const int delay : {0, 1}) {
    auto world = flat_world(2);
    const BodyId support = put(world, box, {50.2, 0.5, 0}, {0, 0, 0}, asleep);
    const BodyId on_top = put(world, box, {49.85, 1.5, 0}, {0, 0, 0}, asleep);
    world.spawn_points = {{{51.1, 0.95, 0}, west}};
    RegionCluster cluster(world, delay);
    ActingPlayer player(cluster, PlayerId{40}, west);
    player.act(Kind::join, 1);
    cluster.step(400);  // Long enough to count as idle.
    INFO("delay " << delay);
    REQUIRE(cluster.owner(support) == 1);
    REQUIRE(cluster.owner(on_top) == 0);
    REQUIRE(cluster.state(on_top).activation == asleep);
    REQUIRE(cluster.core(0).physics().is_stand_in(support));

    PlayerCommand grab = player.next(Kind::grab);
    grab.target = support;
    grab.yaw = 0;  // Carries it to where it looks: north, and away.
    cluster.command(grab);
    cluster.step(150);
    for (int more = 0; more < 20 && !(cluster.owner(support) && cluster.owner(on_top)); ++more)
      cluster.step();
    REQUIRE(cluster.state(support).position.z < -1);
    CHECK(cluster.state(on_top).position.y < 1.0);
    CHECK(cluster.core(0).statistics().struck_stand_ins == 0);
    CHECK(cluster.core(1).statistics().struck_stand_ins == 0);
  }
}
