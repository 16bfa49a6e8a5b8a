// What a policy is shown, while bodies fall asleep, are woken, come and go.
#include "server/region/view/hosted_bodies.h"

#include <limits>
#include <random>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/region_cluster.h"

using namespace aureole;
using namespace aureole::testing;

namespace {

constexpr double depth_m = 12, everything_m = std::numeric_limits<double>::infinity();

/// A region of two, with bodies of its own, as RegionCore would look at it.
struct Region {
  explicit Region(const WorldDefinition& definition)
      : world(definition),
        map({world.regions[0].area, world.regions[1].area}),
        hosting(world, RegionId{0}, Incarnation{1}),
        bodies(map, RegionId{0}, hosting.statics()) {}

  std::vector<HostedBody>& look(std::vector<BodyId> asked_for = {},
                                std::vector<BodyId> stirred = {}, double look_m = depth_m) {
    now = now + 1;
    bodies.begin(hosting, true, now);
    bodies.show_within(look_m, {});
    return bodies.look(hosting, {watch, 0.128, asked_for, stirred}, now);
  }
  void step(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      hosting.physics().step(tick_s);
      look();
    }
  }
  const HostedBody* shown(BodyId id) {
    const auto& all = look();
    const auto at = index_of(all, id);
    return at ? &all[*at] : nullptr;
  }
  BodyId spawn(int n, double x, Activation activation) {
    NewBody body{BodyId::world(static_cast<std::uint32_t>(n)), box, {}};
    body.state.position = {x, 0.5, 0};
    body.state.activation = activation;
    hosting.spawn(std::span(&body, 1));
    return body.id;
  }

  WorldDefinition world;
  PartitionMap map;
  Hosting hosting;
  StandInWatch watch;
  HostedBodies bodies;
  Tick now;
};

}  // namespace

TEST_CASE("who sleeps is kept apart, and who is woken without moving rests on") {
  Region region(flat_world(2));
  const BodyId id = region.spawn(0, 45, Activation::asleep);
  REQUIRE(region.shown(id) == nullptr);
  REQUIRE(region.bodies.sleepers()->place_of(id));
  REQUIRE(region.hosting.lies_still(id, region.now));
  region.hosting.physics().wake(id);
  const HostedBody* woken = region.shown(id);
  REQUIRE(woken != nullptr);
  REQUIRE_FALSE(woken->asleep);
  REQUIRE(woken->still_ticks >= resting_ticks);
  REQUIRE_FALSE(region.bodies.sleepers()->place_of(id));
  region.hosting.physics().set_velocity(id, {3, 0, 0}, {0, 0, 0});
  REQUIRE(region.shown(id)->still_ticks == 0);
  region.step(200);
  REQUIRE(region.shown(id) == nullptr);
  REQUIRE(region.bodies.sleepers()->place_of(id));
  region.hosting.physics().wake(id);
  // Even before the next look: stand-ins are watched before it.
  REQUIRE(region.hosting.lies_still(id, region.now + 1));
}

TEST_CASE("a sleeper is shown when something is to happen with it, and so is who is asked for") {
  Region region(flat_world(2));
  const BodyId near = region.spawn(0, 45, Activation::asleep);
  const BodyId deep = region.spawn(1, 20, Activation::asleep);
  const BodyId deep_awake = region.spawn(2, 10, Activation::awake);
  REQUIRE(region.look().empty());
  REQUIRE(region.look({}, {near, deep}).size() == 1);
  REQUIRE(region.look({}, {near, deep}, everything_m).size() == 3);
  REQUIRE(region.look({deep_awake})[0].id == deep_awake);
  // A sleeper that is asked for is found by its name.
  REQUIRE(region.look({deep}).empty());
  REQUIRE(region.bodies.sleepers()->place_of(deep));
}

TEST_CASE("a deeper strip shows more in the same decision, and so does a look at everything") {
  Region region(flat_world(2));
  for (const int n : {0, 1, 2}) region.spawn(n, 45 - 15.0 * n, Activation::awake);
  region.bodies.begin(region.hosting, true, Tick{1});
  std::size_t expected = 1;
  for (const double look_m : {depth_m, 2 * depth_m, everything_m}) {
    region.bodies.show_within(look_m, {});
    const auto& shown = region.bodies.look(region.hosting, {region.watch, 0.128, {}, {}}, Tick{1});
    REQUIRE(shown.size() == expected++);
    const View* view = region.bodies.view();
    REQUIRE((view == nullptr) == (look_m == everything_m));
    if (view != nullptr) REQUIRE(view->holds(30, 0) == (look_m > depth_m));
  }
}

TEST_CASE("it is known since when somebody has been looked at here") {
  Region region(flat_world(2));
  region.spawn(0, 45, Activation::awake);
  for (const std::int64_t tick : {5, 9}) {
    region.bodies.begin(region.hosting, false, Tick{tick});
    region.bodies.show_within(everything_m, {});
    const auto& shown =
        region.bodies.look(region.hosting, {region.watch, 0.128, {}, {}}, Tick{tick});
    REQUIRE(shown.size() == 1);
    CHECK(shown[0].came == Tick{5});
  }
}

TEST_CASE("a policy that looks at everything is shown everybody") {
  Region region(flat_world(2));
  region.spawn(0, 45, Activation::asleep);
  region.spawn(1, 20, Activation::awake);
  region.bodies.begin(region.hosting, false, Tick{1});
  region.bodies.show_within(everything_m, {});
  REQUIRE(region.bodies.look(region.hosting, {region.watch, 0.128, {}, {}}, Tick{1}).size() == 2);
  REQUIRE(region.bodies.sleepers() == nullptr);
}

TEST_CASE("whatever happens, everybody is either shown or asleep where it lies") {
  Region region(flat_world(2));
  std::mt19937 random(3);
  std::vector<BodyId> here;
  int next = 0, asleep = 0;
  for (int round = 0; round < 600; ++round) {
    const auto any = [&] { return here[random() % here.size()]; };
    switch (random() % 6) {
      case 0:
      case 1:
        here.push_back(region.spawn(next++, 2.0 * (random() % 24),
                                    random() % 2 ? Activation::asleep : Activation::awake));
        break;
      case 2:
        if (!here.empty()) region.hosting.physics().apply_impulse(any(), {0, 2000, 0});
        break;
      case 3:
        if (!here.empty()) region.hosting.physics().wake(any());
        break;
      case 4:
        if (here.size() < 10) break;
        region.hosting.remove(std::vector{here.front()});
        here.erase(here.begin());
        break;
      default:
        if (here.size() < 10) break;
        // Away and back between two looks, under another epoch.
        const BodyId id = any();
        auto gone = region.hosting.release(std::vector{id}, region.now, Hosting::Cut::nowhere);
        region.hosting.accept(gone.group, RegionId{1}, region.now);
    }
    if (random() % 2 == 0) region.hosting.physics().step(tick_s);
    const auto& shown = region.look({}, {}, everything_m);
    const Sleepers& sleepers = *region.bodies.sleepers();
    REQUIRE(shown.size() + sleepers.size() == here.size());
    for (const BodyId id : here) {
      const auto place = sleepers.place_of(id);
      REQUIRE(place.has_value() == region.hosting.physics().is_asleep(id));
      REQUIRE(place.has_value() != index_of(shown, id).has_value());
      if (!place) continue;
      ++asleep;
      const HostedBody& body = sleepers.body(*place);
      REQUIRE(body.position == region.hosting.physics().position(id));
      REQUIRE(body.slot == region.hosting.physics().glance(id).slot());
      REQUIRE(body.changed_owner == region.hosting.changed_owner(id));
    }
  }
  REQUIRE(asleep > 1000);
}
