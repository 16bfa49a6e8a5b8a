// What players throw across a boundary hits what it would hit on one server, whoever throws.
#include <algorithm>

#include "tests/support/acting_player.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/scenarios/overlap_watch.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr PlayerId me{40};        // Stands 0.9 m east of the spawn point.
constexpr float east = -1.5708f;  // Yaw 0 looks along -z and grows to the left.
constexpr int boundary_m = 12;

struct Scene {
  WorldDefinition world;
  BodyId target;

  /// The thrower stands at x = 10.6, the near side of a box in the way at `face_m`.
  Scene(int columns, double face_m) : world(flat_world(columns, boundary_m)) {
    world.spawn_points = {{{9.7, 0.95, 0}, 0}};
    target = put(world, box, {face_m + 0.5, 0.5, 0}, {0, 0, 0}, Activation::asleep);
    put(world, box, {face_m + 0.5, 1.5, 0}, {0, 0, 0}, Activation::asleep);
  }
};

struct Outcome {
  double fastest_mps = 0;      ///< Of the upper box, along the throw.
  int ticks_until_thrown = 0;  ///< From the command on.
  bool was_cut = false;        ///< The box was the other server's when the command came.
  int overlaps = 0;
  std::uint64_t struck = 0;
};

constexpr int long_idle_ticks = static_cast<int>(Players::idle_ticks) + 400;

/// The player throws after what `before`, in which it joins, does, and is watched.
template <class Before>
Outcome throw_after(const Scene& scene, int delay, Before&& before) {
  RegionCluster cluster(scene.world, delay);
  ActingPlayer player(cluster, me, east);
  const BodyId upper = BodyId::world(1), thrown = BodyId::thrown(me, 0);
  before(cluster, player);
  Outcome out;
  out.was_cut = cluster.owner(upper) != cluster.owner(BodyId::avatar(me));
  player.act(Kind::throw_body);
  OverlapWatch watch(scene.world);
  bool is_out = false;
  for (int tick = 0; tick < 60; ++tick) {
    cluster.step();
    watch.look(cluster, scene.world);
    is_out = is_out || cluster.owner(thrown).has_value();
    if (!is_out) ++out.ticks_until_thrown;
    if (cluster.owner(upper))
      out.fastest_mps = std::max(out.fastest_mps, double{cluster.state(upper).linear_velocity.x()});
  }
  REQUIRE(is_out);
  out.overlaps = watch.overlaps();
  for (int i = 0; i < static_cast<int>(scene.world.regions.size()); ++i)
    out.struck += cluster.core(i).statistics().struck_stand_ins;
  return out;
}

/// The player does nothing for so long, and then throws.
Outcome throw_after_ticks(const Scene& scene, int delay, int idle_ticks) {
  return throw_after(scene, delay, [&](RegionCluster& cluster, ActingPlayer& player) {
    player.act(Kind::join, 0);
    cluster.step(idle_ticks);
  });
}

void compare_idle_throw(double face_m) {
  const Outcome one = throw_after_ticks(Scene(1, face_m), 0, long_idle_ticks);
  REQUIRE(one.fastest_mps > 3);
  CHECK(one.ticks_until_thrown == 0);
  for (const int delay : {0, 1})
    for (const int phase : {0, 3, 6}) {  // Servers that sleep decide at times only.
      const Outcome two = throw_after_ticks(Scene(2, face_m), delay, long_idle_ticks + phase);
      INFO("face at " << face_m << " m, delay " << delay << ", phase " << phase);
      REQUIRE(two.was_cut);
      CHECK(two.fastest_mps == Approx(one.fastest_mps).epsilon(0.05));
      CHECK(two.overlaps == 0);
      CHECK(two.struck == 0);
      // Nobody waits for longer than it takes to fetch what may be hit: 8 steps, and the way there.
      CHECK(two.ticks_until_thrown <= 9 + 2 * delay);
    }
}

}  // namespace

TEST_CASE("what an idle player throws across a boundary strikes as on one server") {
  // Beyond the boundary by so little that the ball is there in its first steps, and farther away.
  for (const double face_m : {12.2, 13.0, 15.0, 17.0}) compare_idle_throw(face_m);
}

TEST_CASE("what a player in play throws across a boundary strikes as on one server, and at once") {
  for (const double face_m : {12.2, 15.0}) {
    const Outcome one = throw_after_ticks(Scene(1, face_m), 0, 40);
    for (const int delay : {0, 1}) {
      const Outcome two = throw_after_ticks(Scene(2, face_m), delay, 40);
      INFO("face at " << face_m << " m, delay " << delay);
      CHECK(two.fastest_mps == Approx(one.fastest_mps).epsilon(0.05));
      CHECK(two.overlaps == 0);
      CHECK(two.struck == 0);
      CHECK(two.ticks_until_thrown <= 1 + delay);  // It may change its server at once.
    }
  }
}

TEST_CASE("an idle player from where nothing thrown soon leaves the region throws at once") {
  Scene scene(2, 40);
  scene.world.spawn_points[0].position.x -= 8;
  CHECK(throw_after_ticks(scene, 1, long_idle_ticks).ticks_until_thrown == 0);
}

TEST_CASE("what is thrown when a neighbour is back strikes what that one has beyond the boundary") {
  for (const double face_m : {12.2, 12.9}) {
    const auto scene_of = [&](int columns) {
      Scene scene(columns, face_m);
      scene.world.spawn_points[0].position.x += 0.9;  // It stands at x = 11.5.
      return scene;
    };
    const Outcome one = throw_after_ticks(scene_of(1), 0, 40);
    for (const int delay : {0, 1})
      for (const int ticks_since : {0, 1, 2, 3, 5, 8}) {
        // Who joins while the link is down knows nothing of what lies there.
        const auto join_alone = [&](RegionCluster& cluster, ActingPlayer& player) {
          cluster.step(10);
          cluster.cut_link(0, 1);
          player.act(Kind::join, 0);
          cluster.step(40);
          cluster.reset_link(0, 1);
          cluster.step(ticks_since);
          while (!cluster.owner(BodyId::avatar(me))) cluster.step();  // It may be on its way.
        };
        const Outcome two = throw_after(scene_of(2), delay, join_alone);
        INFO("face at " << face_m << " m, delay " << delay << ", " << ticks_since
                        << " ticks after the link was back");
        CHECK((two.was_cut || ticks_since > 3));
        CHECK(two.fastest_mps == Approx(one.fastest_mps).epsilon(0.05));
        CHECK(two.overlaps == 0);
        CHECK(two.struck == 0);
        // A round trip and the reach time; it may change its server then.
        CHECK(two.ticks_until_thrown + ticks_since <= 14 + 2 + delay);
      }
  }
}
