// A blast throws what lies cut across a boundary as it would on one server.
#include <algorithm>

#include "tests/support/acting_player.h"
#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"
#include "tests/unit/region/scenarios/overlap_watch.h"

using namespace aureole;
using namespace aureole::testing;
using Kind = PlayerCommand::Kind;

namespace {

constexpr PlayerId me{40};

/// Two towers face to face at x = 12, asleep. Whoever blasts stands so far away that nothing else
/// of what it does concerns them.
struct Towers {
  WorldDefinition world;
  std::vector<BodyId> boxes;

  /// Columns between these planes.
  explicit Towers(std::vector<double> planes_x = {})
      : world(flat_world(static_cast<int>(planes_x.size()) + 1)) {
    for (std::size_t i = 0; i < planes_x.size(); ++i)
      world.regions[i].area.max_x = world.regions[i + 1].area.min_x = planes_x[i];
    world.spawn_points = {{{5.5, 0.95, 0}, 0}};
    for (const double x : {11.5, 12.5})
      for (const double y : {0.5, 1.5})
        boxes.push_back(put(world, box, {x, y, 0}, {0, 0, 0}, Activation::asleep));
  }
};

struct Outcome {
  bool was_cut = false;  ///< When the command came.
  bool together = true;  ///< While it threw them.
  std::vector<double> fastest_mps;
  int overlaps = 0;
  std::uint64_t struck = 0;
};

Outcome blast(const Towers& towers, int delay, int idle_ticks) {
  RegionCluster cluster(towers.world, delay);
  ActingPlayer player(cluster, me);
  player.act(Kind::join, 0);
  cluster.step(idle_ticks);
  Outcome out;
  const auto owner = [&](std::size_t i) { return cluster.owner(towers.boxes[i]); };
  out.was_cut = owner(0) != owner(2) && owner(1) != owner(3);
  player.act(Kind::blast);
  OverlapWatch watch(towers.world);
  out.fastest_mps.assign(towers.boxes.size(), 0);
  for (int tick = 0; tick < 60; ++tick) {
    const double before = *std::max_element(out.fastest_mps.begin(), out.fastest_mps.end());
    cluster.step();
    watch.look(cluster, towers.world);
    for (std::size_t i = 0; i < towers.boxes.size(); ++i) {
      if (!owner(i)) continue;
      const double speed = double{cluster.state(towers.boxes[i]).linear_velocity.norm()};
      out.fastest_mps[i] = std::max(out.fastest_mps[i], speed);
    }
    const double fastest = *std::max_element(out.fastest_mps.begin(), out.fastest_mps.end());
    if (before < 1 && fastest >= 1)
      for (std::size_t i = 1; i < towers.boxes.size(); ++i)
        out.together = out.together && owner(i) && owner(i) == owner(0);
  }
  out.overlaps = watch.overlaps();
  for (std::size_t i = 0; i < towers.world.regions.size(); ++i)
    out.struck += cluster.core(static_cast<int>(i)).statistics().struck_stand_ins;
  return out;
}

void compare(const std::vector<double>& planes_x) {
  const Outcome one = blast(Towers(), 0, 40);
  REQUIRE(one.fastest_mps[3] > 1);
  for (const int delay : {0, 1})
    for (const int idle_ticks : {40, 43, 46}) {  // Servers that sleep decide at times only.
      const Outcome cut = blast(Towers(planes_x), delay, idle_ticks);
      INFO("delay " << delay << ", idle for " << idle_ticks << " ticks");
      REQUIRE(cut.was_cut);
      CHECK(cut.together);
      CHECK(cut.overlaps == 0);
      CHECK(cut.struck == 0);
      for (std::size_t i = 0; i < one.fastest_mps.size(); ++i)
        CHECK(cut.fastest_mps[i] == Approx(one.fastest_mps[i]).epsilon(0.05));
    }
}

}  // namespace

TEST_CASE("what a blast will throw out of a cut is on one server before it happens") {
  compare({12});
}

TEST_CASE("what a blast will throw far from whoever blasts is on one server before it happens") {
  // The player is the first server's, and nothing but the blast concerns the other two.
  compare({10.5, 12});
}
