// A region that dies and starts again: nothing is lost, nothing is doubled, nothing comes back that
// was removed.
#include <random>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/recovery/recovering.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

using Disk = RegionCluster::Disk;
using Sent = RegionCluster::Sent;

/// Steps until region 1 has the body.
void step_until_owned_by(RegionCluster& cluster, BodyId id, int region) {
  for (int n = 0; n < 500 && cluster.owner(id) != region; ++n) cluster.step();
  REQUIRE(cluster.owner(id) == region);
}

}  // namespace

TEST_CASE("a rolling ball loses at most 100 ms of its motion when its region dies") {
  auto world = flat_world(2);
  const BodyId id = put(world, ball, {10, 0.3, 0}, {6, 0, 0});
  for (int extra = 0; extra < 7; ++extra) {
    RegionCluster cluster(world);
    cluster.give_disks();
    cluster.step(60 + extra);
    const BodyState before = cluster.state(id);
    const Version version = *cluster.store().version(id);
    cluster.kill(0);
    cluster.kill_store();
    cluster.step(30);
    REQUIRE(cluster.start_again(0));
    step_until_recovered(cluster);
    const BodyState after = cluster.state(id);
    // One more step is taken in the tick in which it is claimed.
    const double lost = before.position.x - after.position.x;
    REQUIRE(lost <= 0.100 * before.linear_velocity.x());
    REQUIRE(lost >= -0.017 * before.linear_velocity.x());
    REQUIRE(after.linear_velocity.x() == Approx(before.linear_velocity.x()).margin(0.1));
    REQUIRE(cluster.core(0).hosting().version(id) > version);
    REQUIRE(cluster.faults().empty());
  }
}

TEST_CASE("a group that was acknowledged an instant before the crash is sent again") {
  auto world = flat_world(2);
  const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.kill_store();
  cluster.stop_disk(1);
  step_until_owned_by(cluster, id, 1);
  cluster.step(3);  // The acknowledgement is back by then.
  const auto& journal = cluster.core(0).journal(RegionId{1});
  REQUIRE(journal.unacknowledged().size() == 1);
  REQUIRE(journal.is_taken(journal.unacknowledged().front()));
  cluster.kill(1);
  cluster.step(5);
  REQUIRE(cluster.start_again(1));
  step_until_recovered(cluster);
  REQUIRE(cluster.owner(id) == 1);
  REQUIRE(cluster.core(1).statistics().recovered == 1);
  cluster.step(20);
  REQUIRE(cluster.core(0).journal(RegionId{1}).unacknowledged().empty());
  REQUIRE(cluster.faults().empty());
}

TEST_CASE("a sender that dies after its group was accepted does not claim it") {
  for (const Sent sent : {Sent::lost, Sent::arrives}) {
    auto world = flat_world(2);
    const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
    RegionCluster cluster(world, 2);
    cluster.give_disks();
    cluster.kill_store();
    cluster.step(7);
    cluster.stop_disk(0);  // It still says that the body is here.
    step_until_owned_by(cluster, id, 1);
    cluster.kill(0, sent);
    cluster.step(10);
    REQUIRE(cluster.start_again(0));
    step_until_recovered(cluster);
    REQUIRE(cluster.owner(id) == 1);
    REQUIRE(cluster.core(0).statistics().recovered == 0);
  }
}

TEST_CASE("a sender that dies with its group in flight claims it, unless it still arrives") {
  for (const Sent sent : {Sent::lost, Sent::arrives}) {
    for (int disk_after = 0; disk_after < 2; ++disk_after) {
      auto world = flat_world(2);
      const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
      RegionCluster cluster(world, 20);
      cluster.give_disks();
      cluster.kill_store();
      cluster.step();
      while (cluster.owner(id)) cluster.step();
      if (disk_after == 1) cluster.step(7);  // Now the snapshot has it in the journal.
      cluster.kill(0, sent);
      cluster.step(3);
      REQUIRE(cluster.start_again(0));
      step_until_recovered(cluster);
      cluster.step(30);
      REQUIRE(cluster.bodies_in_world() == 1);
      const std::uint64_t claimed = cluster.core(0).statistics().recovered;
      REQUIRE(claimed == (sent == Sent::lost ? 1 : 0));
      step_until_owned_by(cluster, id, 1);
      REQUIRE(cluster.faults().empty());
    }
  }
}

TEST_CASE("a receiver that dies after it passed a group on to a third does not take it again") {
  auto world = flat_world(3, 4);
  const BodyId id = put(world, ball, {3.5, 0.3, 0}, {8, 0, 0});
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.kill_store();
  cluster.step();
  cluster.stop_disk(1);
  step_until_owned_by(cluster, id, 2);
  // For region 0 the group is not durable, so it sends it again.
  REQUIRE_FALSE(cluster.core(0).journal(RegionId{1}).unacknowledged().empty());
  cluster.kill(1);
  cluster.step(4);
  REQUIRE(cluster.start_again(1));
  step_until_recovered(cluster);
  REQUIRE(cluster.owner(id) == 2);
  REQUIRE(cluster.core(1).statistics().recovered == 0);
}

TEST_CASE("of two neighbours that are down at once exactly one claims a body that moved") {
  // Which disks knew of the handoff: the sender's, the receiver's.
  for (const auto& [sender, receiver] : {std::pair(true, true), std::pair(true, false),
                                         std::pair(false, true), std::pair(false, false)}) {
    for (const bool with_store : {false, true}) {
      auto world = flat_world(3);
      const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
      const BodyId idle = put(world, box, {20, 0.5, 0});
      RegionCluster cluster(world);
      cluster.give_disks();
      if (!with_store) cluster.kill_store();
      cluster.step(7);
      if (!sender) cluster.stop_disk(0);
      if (!receiver) cluster.stop_disk(1);
      step_until_owned_by(cluster, id, 1);
      cluster.step(sender || receiver ? 8 : 1);
      cluster.kill(1);
      cluster.step(2);
      cluster.kill(0);
      cluster.step(5);
      REQUIRE(cluster.start_again(1));
      cluster.step(80);
      REQUIRE(cluster.core(1).recovering());  // It waits for region 0.
      REQUIRE(cluster.core(1).recovery_waits_for().front() == "region r0");
      REQUIRE(cluster.start_again(0));
      step_until_recovered(cluster);
      REQUIRE(cluster.owner(id));
      REQUIRE(cluster.owner(idle) == 0);
      cluster.step(20);
      REQUIRE(cluster.bodies_in_world() == 2);
      REQUIRE(cluster.faults().empty());
    }
  }
}

TEST_CASE("a region whose disk is lost is rebuilt from the gateway's store") {
  auto world = flat_world(2);
  const BodyId rolling = put(world, ball, {10, 0.3, 0}, {6, 0, 0});
  const BodyId resting = put(world, box, {20, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  const BodyId other = put(world, box, {70, 0.5, 0}, {0, 0, 0}, Activation::asleep);
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.step(100);
  const BodyState before = cluster.state(rolling);
  cluster.kill(0);
  cluster.step(20);
  REQUIRE(cluster.start_again(0, Disk::lost));
  step_until_recovered(cluster);
  const BodyState after = cluster.state(rolling);
  REQUIRE(after.position.x == Approx(before.position.x).margin(0.1));
  REQUIRE(after.linear_velocity.x() == Approx(before.linear_velocity.x()).margin(0.2));
  REQUIRE(cluster.core(0).physics().is_asleep(resting));
  REQUIRE(cluster.owner(other) == 1);
  cluster.step(20);
  REQUIRE(cluster.store().size() == 3);
  REQUIRE(cluster.faults().empty());
}

TEST_CASE("a region that nobody knows anything of begins anew with its part of the world file") {
  auto world = flat_world(2);
  const BodyId here = put(world, box, {20, 0.5, 0});
  const BodyId gone = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
  RegionCluster cluster(world);
  step_until_owned_by(cluster, gone, 1);
  cluster.step(5);
  cluster.kill_store();
  cluster.kill(0);
  REQUIRE(cluster.start_again(0, Disk::lost));
  step_until_recovered(cluster);
  REQUIRE(cluster.owner(here) == 0);
  REQUIRE(cluster.owner(gone) == 1);
}

TEST_CASE("nobody takes anything back over a link that is silent one way") {
  for (const bool towards_receiver : {true, false}) {
    auto world = flat_world(2);
    const BodyId id = put(world, ball, {49.5, 0.3, 0}, {6, 0, 0});
    RegionCluster cluster(world);
    cluster.give_disks();
    cluster.step();
    if (towards_receiver)
      cluster.silence(0, 1);
    else
      cluster.silence(1, 0);
    for (int n = 0; n < 700; ++n) {
      cluster.step();
      // Once it has been handed over it is never region 0's again: silence proves nothing.
      if (cluster.core(0).statistics().migrations_out == 1) REQUIRE(cluster.owner(id) != 0);
    }
    REQUIRE(cluster.core(0).statistics().migrations_out == 1);
    REQUIRE(cluster.bodies_in_world() == 1);
    cluster.reset_link(0, 1);
    step_until_owned_by(cluster, id, 1);
    cluster.step(20);
    REQUIRE(cluster.core(0).journal(RegionId{1}).unacknowledged().empty());
  }
}

TEST_CASE("a snapshot that is damaged or not of this region counts as none") {
  auto world = flat_world(2);
  const BodyId id = put(world, box, {20, 0.5, 0});
  RegionCluster cluster(world);
  cluster.give_disks();
  cluster.step(10);
  const Bytes good = cluster.disk(0);
  const Bytes other = cluster.disk(1);
  cluster.kill(0);
  SECTION("cut short") {
    cluster.disk(0).resize(good.size() / 2);
    REQUIRE(cluster.start_again(0).error().message.find("not a valid snapshot") !=
            std::string::npos);
  }
  SECTION("of another region") {
    cluster.disk(0) = other;
    REQUIRE(cluster.start_again(0).error().message == "the snapshot is of region 1; expected 0");
  }
  SECTION("with any byte changed") {
    std::minstd_rand random(1);
    for (int n = 0; n < 30; ++n) {
      Bytes bad = good;
      bad[random() % bad.size()] ^= static_cast<std::byte>(1 + random() % 255);
      RegionCore core(world, RegionId{0}, Incarnation{9});
      static_cast<void>(core.recover(bad));  // It is refused or harmless.
      core.peer_up(PeerId{1}, Incarnation{1});
      core.step(Tick{20});
    }
    REQUIRE(cluster.start_again(0));
  }
  step_until_recovered(cluster, 1000);
  REQUIRE(cluster.owner(id) == 0);
}

TEST_CASE("whatever dies, no body is lost and none has two owners") {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    INFO("seed " << seed);
    std::minstd_rand random(seed);
    const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
    auto world = flat_world(4, 6);
    for (int n = 0; n < 40; ++n)
      put(world, n % 3 == 0 ? box : ball, {0.5 + below(230) / 10.0, 0.6 + n % 4, n * 1.5 - 30},
          {static_cast<float>(below(17)) - 8, 0, static_cast<float>(below(5)) - 2});
    world.bounds.min.x() = -10'000;
    world.bounds.max.x() = 10'000;
    RegionCluster cluster(world, below(4));
    cluster.give_disks();
    std::map<BodyId, Version> highest;
    bool store_up = true;
    for (int round = 0; round < 12; ++round) {
      for (int n = 5 + below(25); n > 0; --n) {
        cluster.step();
        for (int i = 0; i < 4; ++i) {
          if (!cluster.is_alive(i)) continue;
          for (BodyId id : cluster.core(i).physics().ids()) {
            static_cast<void>(cluster.owner(id));  // Throws if there are two.
            const Version version = cluster.core(i).hosting().version(id);
            REQUIRE(version >= highest[id]);
            highest[id] = version;
          }
        }
      }
      const int i = below(4);
      switch (below(6)) {
        case 0:
          if (store_up) cluster.kill_store();
          if (!store_up) cluster.start_store();
          store_up = !store_up;
          break;
        case 1:
          if (cluster.is_alive(i) && cluster.is_alive((i + 1) % 4))
            cluster.reset_link(i, (i + 1) % 4);
          break;
        default:
          if (cluster.is_alive(i))
            cluster.kill(i, below(2) == 0 ? Sent::lost : Sent::arrives);
          else
            REQUIRE(cluster.start_again(i));
      }
    }
    for (int i = 0; i < 4; ++i)
      if (!cluster.is_alive(i)) REQUIRE(cluster.start_again(i));
    step_until_recovered(cluster, 2000);
    cluster.step(30);
    REQUIRE(cluster.bodies_in_world() == 40);
    for (int i = 0; i < 4; ++i) REQUIRE(cluster.core(i).statistics().version_conflicts == 0);
    REQUIRE(cluster.faults().empty());
  }
}

TEST_CASE("the boundary of a region that is down is a wall, but not to what is already across") {
  auto world = flat_world(2);
  const BodyId comes = put(world, ball, {48, 0.3, 0}, {6, 0, 3});
  const BodyId across = put(world, ball, {50.2, 0.3, 8}, {6, 0, 0});
  world.bodies[1].host = RegionId{0};
  RegionCluster cluster(world);
  cluster.step(1);
  REQUIRE(cluster.owner(across) == 0);
  cluster.cut_link(0, 1);
  cluster.step(100);
  REQUIRE(cluster.state(comes).position.x < 50);
  REQUIRE(cluster.state(comes).position.x > 49.5);
  REQUIRE(cluster.state(comes).position.z > 1);  // Along the wall it goes on.
  REQUIRE(cluster.state(across).position.x > 53);
}
