// Where the paper's bodies come into which regions.
#include "server/measure/workload/workload.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "server/experiment/scenario/scenario.h"
#include "server/worlds/injector.h"
#include "server/worlds/region_tiling.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

WorldDefinition world_of(const std::string& layout, int servers,
                         double region_m = WorkloadOptions{}.region_m) {
  WorkloadOptions options;
  options.region_m = region_m;
  options.layout = layout;
  options.servers = servers;
  auto world = workload_world(options);
  REQUIRE(world);
  return *world;
}

bool beside_boundary(const Injector& injector) {
  return injector.name.starts_with("boundary");
}

}  // namespace

TEST_CASE("every layout has two volumes for each piece of boundary and one for each centre") {
  const std::map<std::pair<std::string, int>, std::pair<int, int>> expected = {
      {{"column", 2}, {2, 2}}, {{"column", 10}, {18, 10}}, {{"corner", 3}, {6, 3}},
      {{"corner", 4}, {8, 4}}, {{"corner", 9}, {24, 9}},   {{"column", 1}, {1, 1}},
      {{"corner", 1}, {1, 1}}};
  for (const auto& [layout, volumes] : expected) {
    CAPTURE(layout.first, layout.second);
    const WorldDefinition world = world_of(layout.first, layout.second);
    CHECK(static_cast<int>(world.regions.size()) == layout.second);
    const auto beside =
        std::count_if(world.injectors.begin(), world.injectors.end(), beside_boundary);
    CHECK(beside == volumes.first);
    CHECK(static_cast<int>(world.injectors.size()) - beside == volumes.second);
  }
}

TEST_CASE("volumes are 12 m from their boundary or at a centre, 15 m up, and inside one region") {
  for (const auto& [layout, servers, region_m] :
       {std::tuple("column", 4, 150.0), std::tuple("corner", 3, 150.0),
        std::tuple("corner", 9, 150.0), std::tuple("corner", 4, 100.0),
        std::tuple("corner", 3, 300.0), std::tuple("column", 10, 800.0)}) {
    CAPTURE(layout, servers, region_m);
    const WorldDefinition world = world_of(layout, servers, region_m);
    const PartitionMap map = partition_of(world);
    for (const Injector& injector : world.injectors) {
      CAPTURE(injector.name);
      const Eigen::Vector3d size = injector.volume.max - injector.volume.min;
      const Eigen::Vector3d centre = (injector.volume.max + injector.volume.min) / 2;
      CHECK(centre.y() == Approx(15));
      CHECK(size.y() == Approx(20));
      const double wide = std::min(size.x(), size.z()), along = std::max(size.x(), size.z());
      CHECK(wide == Approx(20));
      CHECK(along == Approx(beside_boundary(injector) ? std::min(150.0, region_m) : 20));
      constexpr double inside = 0.001;
      CHECK(map.region_at(injector.volume.min.x() + inside, injector.volume.min.z() + inside) ==
            map.region_at(injector.volume.max.x() - inside, injector.volume.max.z() - inside));
      double nearest_m = 1e9;
      for (const BoundarySegment& s : map.boundaries()) {
        const double x = std::clamp(centre.x(), s.from_x, s.to_x);
        const double z = std::clamp(centre.z(), s.from_z, s.to_z);
        nearest_m = std::min(nearest_m, std::hypot(centre.x() - x, centre.z() - z));
      }
      CHECK(nearest_m == Approx(beside_boundary(injector) ? 12 : region_m / 2));
    }
  }
}

TEST_CASE("160 bodies come each second, half of them beside boundaries, never many in one tick") {
  const WorldDefinition world = world_of("column", 10);
  const auto made_by = [&](Tick tick) {
    std::pair<std::uint64_t, std::uint64_t> made{0, 0};
    for (const Injector& injector : world.injectors)
      (beside_boundary(injector) ? made.first : made.second) += injected_count(injector, tick);
    return made;
  };
  std::uint64_t before = made_by(Tick{0}).first + made_by(Tick{0}).second;
  for (Tick tick{1}; tick <= Tick{3750}; tick = tick + 1) {
    const auto [beside, at_centres] = made_by(tick);
    REQUIRE(beside + at_centres - before <= 4);
    before = beside + at_centres;
  }
  CHECK(made_by(Tick{3750}).first == Approx(4800).margin(18));
  CHECK(made_by(Tick{3750}).second == Approx(4800).margin(10));
  CHECK(made_by(Tick{5000}) == made_by(Tick{3750}));
}

TEST_CASE("the world in one region has the same injectors") {
  const WorldDefinition cut = world_of("corner", 4), whole = in_one_region(cut);
  CHECK(whole.regions.size() == 1);
  CHECK(whole.regions.front().area.contains(-1e6, 1e6));
  REQUIRE(whole.injectors.size() == cut.injectors.size());
  for (std::size_t i = 0; i < cut.injectors.size(); ++i) {
    const InjectedBody a = injected_body(cut.injectors[i], 7),
                       b = injected_body(whole.injectors[i], 7);
    CHECK(a.state.position == b.state.position);
    CHECK(a.state.linear_velocity == b.state.linear_velocity);
    CHECK(a.prototype == b.prototype);
  }
}

TEST_CASE("layouts that the paper does not have are refused in a sentence") {
  WorkloadOptions options;
  options.layout = "corner";
  options.servers = 5;
  auto world = workload_world(options);
  REQUIRE_FALSE(world);
  CHECK(world.error().message == "corners are measured on 1, 3, 4 or 9 servers, not on 5");
  options.layout = "column";
  options.servers = 11;
  world = workload_world(options);
  REQUIRE_FALSE(world);
  CHECK(world.error().message == "columns are measured on 1 to 10 servers, not on 11");
}

TEST_CASE("each region of a grid gets as many bodies, whatever the grid's size") {
  for (const int servers : {4, 16, 64}) {
    CAPTURE(servers);
    const WorldDefinition world = world_of("grid", servers);
    const PartitionMap map = partition_of(world);
    std::vector<double> beside(map.size(), 0), at_centre(map.size(), 0);
    for (const Injector& injector : world.injectors) {
      const Eigen::Vector3d centre = (injector.volume.max + injector.volume.min) / 2;
      const RegionId region = map.region_at(centre.x(), centre.z());
      (beside_boundary(injector) ? beside : at_centre)[region.value] += injector.rate_per_s;
    }
    for (std::size_t r = 0; r < map.size(); ++r) {
      CHECK(beside[r] == Approx(20));
      CHECK(at_centre[r] == Approx(20));
    }
    CHECK(world.max_bodies >= static_cast<std::uint32_t>(servers) * 40 * 60);
  }
}

TEST_CASE("grids are squares") {
  for (const int servers : {1, 5, 81}) {
    WorkloadOptions options;
    options.layout = "grid";
    options.servers = servers;
    const auto world = workload_world(options);
    REQUIRE_FALSE(world);
    CHECK(world.error().message.starts_with("grids are measured on 4, 9, 16, 25, 36, 49 or 64"));
  }
}
