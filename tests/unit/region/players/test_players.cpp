// Players in a world of several regions: in order, once each, and never stopped by a boundary.
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr PlayerId me{42};
const BodyId my_body = BodyId::avatar(me);
constexpr float east = -1.5708f;  // Yaw 0 looks along -z and grows to the left.

struct Player {
  RegionCluster& cluster;
  std::uint32_t session = 1;
  std::uint32_t sequence = 0;

  PlayerCommand make(Kind kind) {
    PlayerCommand c;
    c.player = me;
    c.session = session;
    c.sequence = ++sequence;
    c.kind = kind;
    c.yaw = east;
    return c;
  }
  void join(int region = 0) { cluster.command(make(Kind::join), region); }
  void hold(std::uint8_t keys_held) {
    auto c = make(Kind::input);
    c.keys = keys_held;
    cluster.command(c);
  }
  void act(Kind kind, BodyId target = {}, float pitch = 0) {
    auto c = make(kind);
    c.target = target;
    c.pitch = pitch;
    cluster.command(c);
  }
};

}  // namespace

TEST_CASE("an avatar stands where it was put, falls asleep, and walks when a key is held") {
  auto world = flat_world(1);
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(120);
  REQUIRE(cluster.state(my_body).activation == Activation::asleep);
  const double from = cluster.state(my_body).position.x;
  player.hold(keys::forward);
  cluster.step(60);
  const double walked = cluster.state(my_body).position.x - from;
  REQUIRE(walked > 3.5);
  REQUIRE(walked < 4.8);
  player.hold(0);
  cluster.step(30);
  REQUIRE(cluster.state(my_body).linear_velocity.norm() < 0.2f);
}

TEST_CASE("an avatar jumps from the ground only") {
  auto world = flat_world(1);
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(30);
  const double ground = cluster.state(my_body).position.y;
  player.hold(keys::jump);
  double highest = ground;
  for (int i = 0; i < 50; ++i) {
    cluster.step();
    highest = std::max(highest, cluster.state(my_body).position.y);
  }
  // One jump of 5.4 m/s rises 1.4 m; a second one in the air would double it.
  REQUIRE(highest - ground > 1.1);
  REQUIRE(highest - ground < 1.6);
}

TEST_CASE("an avatar walks through every region without being stopped") {
  auto world = flat_world(4, 20);
  for (const int delay : {0, 2}) {
    RegionCluster cluster(world, delay);
    Player player{cluster};
    player.join();
    cluster.step(30);
    player.hold(keys::forward | keys::sprint);
    double before = cluster.state(my_body).position.x;
    for (int i = 0; i < 450; ++i) {
      cluster.step();
      if (!cluster.owner(my_body)) continue;
      const double x = cluster.state(my_body).position.x;
      if (i > 30 && x < 75) REQUIRE(x - before < 0.13 * (3 + delay));
      REQUIRE(x >= before - 1e-6);
      before = x;
    }
    REQUIRE(before > 61);
    REQUIRE(cluster.owner(my_body) == 3);
    REQUIRE(cluster.bodies_in_world() == 1);
  }
}

TEST_CASE("commands are applied in order and once, however they arrive") {
  auto world = flat_world(1);
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(2);
  auto first = player.make(Kind::throw_body), second = player.make(Kind::throw_body);
  cluster.command(second);
  cluster.step();
  REQUIRE(cluster.bodies_in_world() == 1);  // Waits for the first.
  cluster.command(first);
  cluster.command(first);
  cluster.command(second);
  cluster.step();
  cluster.command(second);
  cluster.step();
  REQUIRE(cluster.bodies_in_world() == 3);
}

TEST_CASE("input sent to the region that an avatar has just left follows it") {
  auto world = flat_world(2, 20);
  RegionCluster cluster(world, 2);
  Player player{cluster};
  player.join();
  cluster.step(5);
  player.hold(keys::forward);
  while (cluster.owner(my_body) == 0) cluster.step();
  REQUIRE_FALSE(cluster.owner(my_body));
  cluster.command(player.make(Kind::throw_body), 0);  // To the old owner, while in flight.
  cluster.step(10);
  REQUIRE(cluster.owner(my_body) == 1);
  REQUIRE(cluster.bodies_in_world() == 2);
  REQUIRE(cluster.store().player(me)->applied_sequence == player.sequence);
}

TEST_CASE("a carried body goes with its carrier through every region") {
  auto world = flat_world(3, 20);
  const BodyId thing = put(world, box, {12, 0.5, 0.9});
  RegionCluster cluster(world, 1);
  Player player{cluster};
  player.join();
  cluster.step(10);
  player.act(Kind::grab, thing);
  cluster.step(20);
  REQUIRE(cluster.state(thing).position.y > 0.8);
  player.hold(keys::forward);
  for (int i = 0; i < 600; ++i) {
    cluster.step();
    if (!cluster.owner(my_body)) continue;
    REQUIRE(cluster.owner(thing) == cluster.owner(my_body));
    REQUIRE(distance(cluster.state(thing).position, cluster.state(my_body).position) < 4);
  }
  REQUIRE(cluster.owner(my_body) == 2);
  player.act(Kind::grab);  // Lets go.
  cluster.step(60);
  REQUIRE(cluster.state(thing).position.y < 0.8);
}

TEST_CASE("a body in another region can be grabbed across the boundary") {
  auto world = flat_world(2, 12);
  const BodyId thing = put(world, box, {12.6, 0.5, 0});
  RegionCluster cluster(world, 1);
  Player player{cluster};
  player.join();
  // Whoever has just come may throw at any moment; what lies near goes home once that has passed.
  cluster.step(300);
  REQUIRE(cluster.owner(my_body) == 0);
  REQUIRE(cluster.owner(thing) == 1);
  player.act(Kind::grab, thing);
  cluster.step(30);
  REQUIRE(cluster.owner(thing) == 0);
  REQUIRE(cluster.store().player(me)->carried == thing);
}

TEST_CASE("a blast at a corner moves bodies of every region at the same tick") {
  auto world = flat_world(2, 12);
  const BodyId left = put(world, ball, {11, 0.3, 2}), right = put(world, ball, {13, 0.3, 2});
  for (const int delay : {0, 3}) {
    RegionCluster cluster(world, delay);
    Player player{cluster};
    player.join();
    cluster.step(40);
    player.act(Kind::blast);
    int ticks = 0;
    while (cluster.state(left).linear_velocity.norm() < 1 && ticks++ < 20) cluster.step();
    REQUIRE(ticks < 11);
    REQUIRE(cluster.state(right).linear_velocity.norm() > 1);
    REQUIRE(cluster.core(1).statistics().late_effects == 0);
  }
}

TEST_CASE("a blast that comes too late is applied, and counted as late") {
  auto world = flat_world(2, 12);
  const BodyId right = put(world, ball, {13, 0.3, 2});
  RegionCluster cluster(world, 12);
  Player player{cluster};
  player.join();
  cluster.step(40);
  player.act(Kind::blast);
  cluster.step(30);
  REQUIRE(cluster.core(1).statistics().late_effects == 1);
  REQUIRE(cluster.state(right).position.x > 13.2);
}

TEST_CASE("a player's oldest thrown body goes first, wherever it has rolled to") {
  auto world = flat_world(2, 12);
  world.max_thrown_per_player = 3;
  RegionCluster cluster(world, 1);
  Player player{cluster};
  player.join();
  cluster.step(5);
  for (int i = 0; i < 6; ++i) {
    player.act(Kind::throw_body);
    cluster.step(40);
  }
  cluster.step(20);
  REQUIRE(cluster.bodies_in_world() == 1 + 3);
  REQUIRE_FALSE(cluster.owner(BodyId::thrown(me, 0)));
  REQUIRE(cluster.owner(BodyId::thrown(me, 5)) == 1);
}

TEST_CASE("a player who is gone keeps the avatar for 30 seconds and then takes all along") {
  auto world = flat_world(1);
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(5);
  player.act(Kind::throw_body);
  player.act(Kind::lost);
  cluster.step(static_cast<int>(Players::keep_lost_ticks) - 5);
  REQUIRE(cluster.owner(my_body) == 0);
  cluster.step(10);
  REQUIRE(cluster.bodies_in_world() == 0);
}

TEST_CASE("a new session goes on with the same avatar and silences the old one") {
  auto world = flat_world(1);
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(5);
  player.act(Kind::lost);
  Player again{cluster, 2};
  again.join();
  cluster.step(5);
  again.hold(keys::forward);
  player.act(Kind::throw_body);
  cluster.step(60);
  REQUIRE(cluster.bodies_in_world() == 1);
  REQUIRE(cluster.state(my_body).position.x > 12);
  cluster.step(static_cast<int>(Players::keep_lost_ticks));
  REQUIRE(cluster.owner(my_body));
}

TEST_CASE("an avatar is not made again by a join for one that exists elsewhere") {
  auto world = flat_world(2, 20);
  RegionCluster cluster(world);
  Player player{cluster};
  auto join = player.make(Kind::join);
  join.target = my_body;
  cluster.command(join, 0);
  cluster.step(5);
  REQUIRE(cluster.bodies_in_world() == 0);
}

TEST_CASE("a player whose spawn point lies in another region starts there") {
  auto world = flat_world(2, 20);
  world.spawn_points = {{{30, 0.95, 0}, 0}};
  RegionCluster cluster(world, 1);
  Player player{cluster};
  player.join(0);
  cluster.step(6);
  REQUIRE(cluster.owner(my_body) == 1);
}

TEST_CASE("an avatar that falls out of the world respawns, others are removed") {
  auto world = flat_world(1);
  world.statics.clear();
  RegionCluster cluster(world);
  Player player{cluster};
  player.join();
  cluster.step(200);
  REQUIRE(cluster.owner(my_body) == 0);
  REQUIRE(cluster.state(my_body).position.y > -21);
}

TEST_CASE("a player who left and comes back under the same name is seen again by the gateways") {
  auto world = flat_world(2, 12);
  RegionCluster cluster(world, 1);
  Player player{cluster, 100};
  player.join();
  cluster.step(5);
  player.act(Kind::throw_body);
  player.hold(keys::forward);
  cluster.step(60);
  REQUIRE(cluster.owner(my_body) == 1);
  player.act(Kind::leave);
  cluster.step(5);
  REQUIRE(cluster.store().size() == 0);
  Player again{cluster, 108};
  again.join();
  cluster.step(5);
  again.act(Kind::throw_body);
  cluster.step(5);
  REQUIRE(cluster.bodies_in_world() == 2);
  REQUIRE(cluster.store().size() == 2);
}
