// Two and four region servers as real processes: bodies roll across, none lost, none doubled.
#include <nlohmann/json.hpp>
#include <set>

#include "server/worlds/world_file.h"
#include "tests/support/catch.h"
#include "tests/support/world_processes.h"

using namespace aureole;
using namespace aureole::testing;
using namespace std::chrono_literals;

namespace {

nlohmann::json body(std::vector<double> position, std::vector<double> velocity, bool asleep) {
  nlohmann::json shape = asleep ? nlohmann::json{{"type", "box"}, {"size", {1, 1, 1}}}
                                : nlohmann::json{{"type", "sphere"}, {"radius", 0.3}};
  nlohmann::json b{{"body", {{"shape", shape}, {"mass_kg", 2}}}, {"position", position}};
  if (asleep)
    b["asleep"] = true;
  else
    b["velocity"] = velocity;
  return b;
}

/// Balls that roll outwards and inwards over all seams of a 2×2 world, and a stack that sleeps.
nlohmann::json rolling_world() {
  nlohmann::json world = nlohmann::json::parse(R"({
    "name": "rolling", "bounds": {"min": [-100, -20, -100], "max": [100, 100, 100]},
    "regions": [{"name": "all", "area": {}}],
    "statics": [{"name": "ground", "shape": {"type": "plane"}, "position": [0, 0, 0]}],
    "spawn_points": [{"position": [20, 1, 20]}]
  })");
  world["bodies"] = nlohmann::json::array();
  for (int i = 0; i < 40; ++i) {
    const double side = i % 2 ? 1 : -1, along = -19 + i;
    world["bodies"].push_back(body({side * 6, 0.3, along}, {-side * 7, 0, 0}, false));
  }
  for (int i = 0; i < 40; ++i) {
    const double side = i % 2 ? 1 : -1, along = -19 + i;
    world["bodies"].push_back(body({along, 3.3, side * 6}, {0, 0, -side * 7}, false));
  }
  for (int i = 0; i < 5; ++i) world["bodies"].push_back(body({-40, 0.5 + i, -40}, {}, true));
  return world;
}

void check_rolling(int regions) {
  const auto path = temporary_file("rolling.json", rolling_world().dump());
  const auto world = load_world(path, {regions});
  REQUIRE((world ? "" : world.error().message) == "");
  WorldProcesses processes(path, regions, false);
  Watcher watcher(*world, processes.addresses());
  REQUIRE(watcher.watch([&] { return watcher.all_complete(); }, 30s));
  const std::size_t bodies = world->bodies.size();
  REQUIRE(watcher.store().size() == bodies);

  for (int i = 0; i < 20; ++i) {
    watcher.watch_for(200ms);
    REQUIRE(watcher.store().size() == bodies);
  }
  REQUIRE(watcher.faults().empty());
  REQUIRE(watcher.owner_changes() >= (regions == 2 ? 30u : 60u));
  // The store names each body once by construction. That none is simulated twice, or by nobody,
  // shows in what the regions count themselves, once nothing is in flight.
  REQUIRE(watcher.watch([&] { return watcher.hosted() == bodies; }, 10s));

  std::vector<ReplicaPose> poses;
  watcher.store().sample(std::int64_t{1} << 60, poses);
  std::size_t at_home = 0;
  for (const ReplicaPose& pose : poses) {
    const RegionId home = region_at(world->regions, pose.position.x, pose.position.z);
    at_home += watcher.store().version(pose.id)->region == home;
  }
  // Those that lie against others across the line are hosted with them; most are where they belong.
  REQUIRE(at_home >= bodies * 3 / 4);
}

}  // namespace

TEST_CASE("balls roll between two region processes and none is lost or doubled") {
  check_rolling(2);
}

TEST_CASE("balls roll between four region processes and none is lost or doubled") {
  check_rolling(4);
}

TEST_CASE("a stack handed over asleep by one process stays asleep in another") {
  auto json = nlohmann::json::parse(R"({
    "name": "stack", "bounds": {"min": [-100, -20, -100], "max": [100, 100, 100]},
    "regions": [{"name": "west", "area": {"max_x": 0}}, {"name": "east", "area": {"min_x": 0}}],
    "statics": [{"name": "ground", "shape": {"type": "plane"}, "position": [0, 0, 0]}],
    "spawn_points": [{"position": [20, 1, 20]}], "bodies": []
  })");
  for (int i = 0; i < 6; ++i) {
    json["bodies"].push_back(body({30, 0.5 + i, 5}, {}, true));
    json["bodies"].back()["host"] = "west";
  }
  const auto path = temporary_file("stack.json", json.dump());
  const auto world = load_world(path);
  REQUIRE((world ? "" : world.error().message) == "");
  WorldProcesses processes(path, 2, false, /*own_rectangles=*/true);
  Watcher watcher(*world, processes.addresses());
  const auto hosted_east = [&] {
    for (std::uint32_t i = 0; i < 6; ++i) {
      const auto version = watcher.store().version(BodyId::world(i));
      if (!version || version->region != RegionId{1}) return false;
    }
    return true;
  };
  REQUIRE(watcher.watch(hosted_east, 30s));
  watcher.watch_for(1s);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const auto key = watcher.store().key_state(BodyId::world(i));
    REQUIRE(key->state.activation == Activation::asleep);
    REQUIRE(key->state.position == WorldPosition{30, 0.5 + i, 5});
    REQUIRE(key->version.epoch == 2);
  }
  REQUIRE(watcher.store().awake_count() == 0);
}
