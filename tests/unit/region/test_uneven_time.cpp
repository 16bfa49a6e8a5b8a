// Servers whose ticks are not even: clocks that are ahead, ticks left out, gateways lost on the
// way.
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr PeerId some_gateway = PeerId::gateway(0);

PlayerCommand command(Kind kind, std::uint32_t sequence) {
  PlayerCommand c;
  c.player = PlayerId{7};
  c.session = 1;
  c.sequence = sequence;
  c.kind = kind;
  return c;
}

void give(RegionCore& core, const PlayerCommand& c) {
  REQUIRE(core.receive(some_gateway, {FrameType::commands, 0, encode_commands(std::span(&c, 1))}));
}

/// Delivers what `from` wants to say to `to` at once.
void carry(RegionCore& from, int from_number, RegionCore& to, int to_number) {
  for (const Outgoing& out : from.outbox()) {
    if (out.to != PeerId{static_cast<std::uint16_t>(to_number)}) continue;
    const auto frame = decode_frame(*out.frame);
    REQUIRE(frame);
    REQUIRE(to.receive(PeerId{static_cast<std::uint16_t>(from_number)}, *frame));
  }
}

/// Two linked cores of one world.
struct Pair {
  RegionCore first, second;
  explicit Pair(const WorldDefinition& world)
      : first(world, RegionId{0}, Incarnation{1}), second(world, RegionId{1}, Incarnation{1}) {
    first.peer_up(PeerId{1}, Incarnation{1});
    second.peer_up(PeerId{0}, Incarnation{1});
  }
  void exchange() {
    carry(first, 0, second, 1);
    carry(second, 1, first, 0);
  }
};

}  // namespace

TEST_CASE(
    "a group from a server whose clock is ahead waits for its tick and then flies on unchanged") {
  auto whole = flat_world(1), split = flat_world(2, 50);
  BodyId flyer;
  for (auto* world : {&whole, &split}) flyer = put(*world, ball, {49, 30, 0}, {8, 0, 0});
  constexpr int ahead = 5;
  Pair two(split);
  RegionCluster one(whole);
  bool waited = false;
  for (int t = 1; t <= 60; ++t) {
    two.first.step(Tick{t + ahead});
    two.second.step(Tick{t});
    two.exchange();
    // The body made its first step with its server's first one, at tick 1 + ahead.
    if (t > ahead) one.step();
    waited = waited || (!two.first.hosting().hosts(flyer) && !two.second.hosting().hosts(flyer));
  }
  REQUIRE(waited);
  REQUIRE(two.second.hosting().hosts(flyer));
  const auto arrived = two.second.physics().state(flyer), expected = one.state(flyer);
  REQUIRE(distance(arrived.position, expected.position) < 1e-3);
  REQUIRE(two.second.statistics().catch_up_steps == 0);
}

TEST_CASE("a blast whose tick is left out strikes with the next step") {
  auto world = flat_world(1);
  const BodyId near = put(world, ball, {12, 0.3, 2});
  RegionCore core(world, RegionId{0}, Incarnation{1});
  core.peer_up(some_gateway, Incarnation{1});
  give(core, command(Kind::join, 1));
  int t = 0;
  while (t < 40) core.step(Tick{++t});
  give(core, command(Kind::blast, 2));
  core.step(Tick{++t});
  REQUIRE(core.physics().state(near).linear_velocity.norm() < 0.1f);
  core.step(Tick{t += 20});  // It was due a few ticks ahead.
  REQUIRE(core.physics().state(near).linear_velocity.norm() > 1);
  const auto struck = core.physics().state(near).linear_velocity;
  core.step(Tick{++t});  // Once.
  REQUIRE(core.physics().state(near).linear_velocity.norm() < struck.norm() + 0.1f);
}

TEST_CASE("a player whose gateway is lost while the avatar is in flight counts as lost") {
  auto world = flat_world(2, 12);
  world.spawn_points[0].position.x = 9;
  Pair two(world);
  for (RegionCore* core : {&two.first, &two.second}) core->peer_up(some_gateway, Incarnation{1});
  give(two.first, command(Kind::join, 1));
  const BodyId body = BodyId::avatar(PlayerId{7});
  PlayerCommand walk = command(Kind::input, 2);
  walk.keys = keys::forward | keys::sprint;
  walk.yaw = -1.5708f;  // East.
  int t = 0;
  two.first.step(Tick{++t});
  two.second.step(Tick{t});
  two.exchange();
  give(two.first, walk);
  while (t == 1 || two.first.hosting().hosts(body)) {
    REQUIRE(t < 200);
    two.first.step(Tick{++t});
    two.second.step(Tick{t});
    if (two.first.hosting().hosts(body)) two.exchange();
  }
  for (RegionCore* core : {&two.first, &two.second}) core->peer_down(some_gateway);
  carry(two.first, 0, two.second, 1);
  for (int i = 0; i < 200; ++i) two.second.step(Tick{++t});
  REQUIRE(two.second.hosting().hosts(body));
  // Nobody holds the keys any more.
  REQUIRE(two.second.physics().state(body).linear_velocity.norm() < 0.1f);
}
