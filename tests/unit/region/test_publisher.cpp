// What gateways hear: everything once, then only what moves.
#include "protocol/wire.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

const wire::ReplicaUpdate* update_for_gateway(RegionCore& core, Frame& keep) {
  for (const Outgoing& out : core.outbox()) {
    if (out.to.is_region()) continue;
    keep = *decode_frame(*out.frame);
    if (keep.type == FrameType::replica_update) return verified<wire::ReplicaUpdate>(keep.payload);
  }
  return nullptr;
}

}  // namespace

TEST_CASE("a new gateway is sent every body once, and a sleeping world costs nothing afterwards") {
  auto world = flat_world(1);
  for (int i = 0; i < 10; ++i) put(world, box, {2.0 * i, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world);
  Frame frame;
  cluster.step();
  REQUIRE(update_for_gateway(cluster.core(0), frame)->keys()->size() == 10);
  for (int i = 0; i < 200; ++i) {
    cluster.step();
    const auto* update = update_for_gateway(cluster.core(0), frame);
    REQUIRE(update->keys()->size() == 0);
    REQUIRE(update->motions()->size() == 0);
  }
}

TEST_CASE("a moving body costs 18 bytes a tick and a key now and then") {
  auto world = flat_world(1);
  put(world, ball, {0, 0.3, 0}, {5, 0, 0});
  RegionCluster cluster(world);
  Frame frame;
  cluster.step();
  unsigned keys = 0, motions = 0;
  for (int i = 0; i < 128; ++i) {
    cluster.step();
    const auto* update = update_for_gateway(cluster.core(0), frame);
    keys += update->keys()->size();
    motions += update->motions()->size();
  }
  REQUIRE(sizeof(wire::ReplicaMotion) == 18);
  REQUIRE(keys == 2);
  REQUIRE(motions == 126);
}

TEST_CASE("the store ends up with the exact key and the same quantised pose as the region") {
  auto world = flat_world(2, 12);
  const BodyId id = put(world, box, {8, 3, 0}, {6, 0, 2});
  RegionCluster cluster(world, 1);
  for (int i = 0; i < 200; ++i) {
    cluster.step();
    if (!cluster.owner(id)) continue;
    const auto pose = cluster.store().sample_body(id, cluster.now().value * tick_us);
    REQUIRE(pose);
    const auto expected = dequantise(quantise(cluster.state(id).position));
    REQUIRE(pose->position == expected);
    REQUIRE(pose->owner.value == *cluster.owner(id));
  }
  REQUIRE(cluster.owner(id) == 1);
}

TEST_CASE("a gateway that joins while a body is in flight hears of it") {
  auto world = flat_world(2);
  const BodyId id = put(world, ball, {49.9, 0.3, 0}, {6, 0, 0});
  RegionCluster cluster(world, 4);
  cluster.step();
  while (cluster.owner(id) == 0) cluster.step();
  cluster.core(0).peer_up(PeerId::gateway(1), Incarnation{1});
  cluster.step();
  bool heard = false;
  for (const Outgoing& out : cluster.core(0).outbox()) {
    if (out.to != PeerId::gateway(1)) continue;
    const Frame frame = *decode_frame(*out.frame);
    if (frame.type != FrameType::replica_update) continue;
    for (const auto* key : *verified<wire::ReplicaUpdate>(frame.payload)->keys())
      heard = heard || BodyId{key->id()} == id;
  }
  REQUIRE(heard);
}

TEST_CASE(
    "a body that is handed over is heard of in every tick, so that it is not seen to falter") {
  auto world = flat_world(2);
  const BodyId id = put(world, ball, {48, 2, 0}, {12, 3, 0});
  RegionCluster cluster(world, 0);
  cluster.step(2);
  for (int i = 0; i < 40; ++i) {
    cluster.step();
    // In flight the receiver owns it from the next tick on; its server has told of this one.
    const auto pose = cluster.store().sample_body(id, cluster.now().value * tick_us);
    const auto before = cluster.store().sample_body(id, (cluster.now().value - 1) * tick_us);
    REQUIRE(pose->position.x - before->position.x == Approx(12 * 0.016).margin(0.02));
  }
  REQUIRE(cluster.owner(id) == 1);
}
