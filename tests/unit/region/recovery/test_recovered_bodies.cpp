// What a region gets back after its death: bodies, players and what they hold, and nothing twice.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/recovery/recovering.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

using Disk = RegionCluster::Disk;

}  // namespace

TEST_CASE("what was removed on purpose does not come back with an old snapshot") {
  for (const bool at_a_neighbour : {false, true}) {
    auto world = flat_world(2);
    world.bounds.max.x() = at_a_neighbour ? 55 : 45;
    const BodyId id = put(world, ball, {at_a_neighbour ? 49.0 : 44.0, 0.3, 0}, {9, 0, 0});
    const BodyId stays = put(world, box, {10, 0.5, 0});
    RegionCluster cluster(world);
    cluster.give_disks();
    cluster.step(2);
    cluster.stop_disk(0);
    if (at_a_neighbour) cluster.kill_store();  // Only the neighbour can tell.
    for (int n = 0; n < 200 && cluster.bodies_in_world() == 2; ++n) cluster.step();
    REQUIRE(cluster.bodies_in_world() == 1);
    cluster.step(10);
    cluster.kill(0);
    REQUIRE(cluster.start_again(0));
    step_until_recovered(cluster);
    REQUIRE_FALSE(cluster.owner(id));
    REQUIRE(cluster.owner(stays) == 0);
    REQUIRE(cluster.core(0).statistics().recovered == 1);
  }
}

TEST_CASE("a body that is thrown after the last snapshot comes back from the store") {
  auto world = flat_world(2);
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.step();
  const PlayerId player{7};
  PlayerCommand command;
  command.player = player;
  command.session = 1;
  command.kind = PlayerCommand::Kind::join;
  cluster.command(command, 0);
  cluster.step(30);
  cluster.stop_disk(0);
  command.kind = PlayerCommand::Kind::throw_body;
  for (std::uint32_t n = 1; n <= 3; ++n) {
    command.sequence = n;
    cluster.command(command);
    cluster.step();
  }
  cluster.step(3);
  REQUIRE(cluster.bodies_in_world() == 4);
  cluster.kill(0);
  cluster.step(5);
  REQUIRE(cluster.start_again(0));
  step_until_recovered(cluster);
  REQUIRE(cluster.bodies_in_world() == 4);
  cluster.step();
  // The store has seen three commands applied: none is applied again, the fourth one is next.
  REQUIRE(cluster.store().player(player)->applied_sequence == 3);
  cluster.command(command);
  cluster.step(20);  // What players do waits until the neighbours have heard of each other.
  REQUIRE(cluster.bodies_in_world() == 4);
  command.sequence = 4;
  cluster.command(command);
  cluster.step(2);
  REQUIRE(cluster.bodies_in_world() == 5);
  REQUIRE(cluster.faults().empty());
}

TEST_CASE("a player goes on with what is carried after the region of the avatar died") {
  auto world = flat_world(2);
  const BodyId thing = put(world, ball, {12.2, 0.3, 0});
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.step();
  const PlayerId player{8};
  PlayerCommand command;
  command.player = player;
  command.session = 5;
  command.kind = PlayerCommand::Kind::join;
  cluster.command(command, 0);
  cluster.step(10);
  command.kind = PlayerCommand::Kind::grab;
  command.sequence = 1;
  command.target = thing;
  cluster.command(command);
  cluster.step(20);
  REQUIRE(cluster.store().player(player)->carried == thing);
  cluster.kill(0);
  cluster.step(30);
  REQUIRE(cluster.start_again(0));
  step_until_recovered(cluster);
  cluster.step(5);
  const auto status = cluster.store().player(player);
  REQUIRE(status->carried == thing);
  REQUIRE(status->applied_sequence == 1);
  const double x = cluster.state(BodyId::avatar(player)).position.z;
  command.kind = PlayerCommand::Kind::input;
  command.sequence = 2;
  command.keys = keys::forward;
  cluster.command(command);
  cluster.step(60);
  REQUIRE(cluster.state(BodyId::avatar(player)).position.z < x - 2);
  REQUIRE(cluster.store().player(player)->carried == thing);
}

TEST_CASE("injected bodies are neither lost nor made twice when their region dies") {
  for (const Disk disk : {Disk::kept, Disk::lost}) {
    auto world = flat_world(2);
    Injector injector;
    injector.name = "rain";
    injector.rate_per_s = 25;
    injector.volume = {{10, 1, -20}, {40, 3, 20}};
    injector.mix = {{ball, 1}};
    injector.duration_s = 4;
    world.injectors.push_back(injector);
    RegionCluster cluster(world);
    cluster.give_disks();
    cluster.step(101);
    cluster.stop_disk(0);
    cluster.step(9);
    cluster.kill(0);
    cluster.step(10);
    REQUIRE(cluster.start_again(0, disk));
    step_until_recovered(cluster);
    cluster.step(200);
    REQUIRE(cluster.bodies_in_world() == 100);
    REQUIRE(cluster.faults().empty());
  }
}

TEST_CASE("a sleeper that was claimed knows what it leans on") {
  auto world = flat_world(2);
  const BodyId below = put(world, box, {25, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId above = put(world, box, {25, 1.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.step(20);
  REQUIRE(cluster.core(0).physics().is_asleep(above));
  cluster.kill(0);
  cluster.step(5);
  REQUIRE(cluster.start_again(0));
  step_until_recovered(cluster);
  const PhysicsWorld& physics = cluster.core(0).physics();
  REQUIRE(physics.is_asleep(above));
  REQUIRE(physics.touching(above) == std::vector{below});
  REQUIRE(physics.touching(below) == std::vector{above});
}
