// A workload's world as a file: read back, it is the same world.
#include "server/measure/workload/workload_file.h"

#include <nlohmann/json.hpp>

#include "server/measure/workload/workload.h"
#include "server/worlds/injector.h"
#include "server/worlds/world_file.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("the world that processes read is the one that is run in virtual time") {
  for (const auto& [layout, servers] :
       {std::pair("column", 2), std::pair("corner", 3), std::pair("grid", 16)}) {
    CAPTURE(layout, servers);
    WorkloadOptions options;
    options.layout = layout;
    options.servers = servers;
    options.seed = 77;
    options.tolerances = {30, 5, 14};
    auto world = workload_world(options);
    REQUIRE(world);
    world->mode = MigrationMode::paper;
    const auto read = parse_world(workload_file(*world).dump(), "workload");
    if (!read) FAIL(read.error().message);
    CHECK(read->mode == MigrationMode::paper);
    CHECK(read->max_bodies == world->max_bodies);
    CHECK(read->tolerances.speed_mps == 30);
    CHECK(read->tolerances.latency_ms == 5);
    CHECK(read->tolerances.frame_time_ms == 14);
    CHECK(read->bounds.min == world->bounds.min);
    CHECK(read->bounds.max == world->bounds.max);
    CHECK(read->physics.gravity == world->physics.gravity);
    CHECK(read->physics.sleep_linear_speed == world->physics.sleep_linear_speed);
    CHECK(read->physics.solver_iterations == world->physics.solver_iterations);
    REQUIRE(read->regions.size() == world->regions.size());
    for (std::size_t r = 0; r < world->regions.size(); ++r)
      CHECK(read->regions[r].area == world->regions[r].area);
    REQUIRE(read->statics.size() == 1);
    CHECK(read->statics[0].body.friction == world->statics[0].body.friction);
    REQUIRE(read->injectors.size() == world->injectors.size());
    for (std::size_t i = 0; i < world->injectors.size(); ++i) {
      const Injector &mine = world->injectors[i], &theirs = read->injectors[i];
      for (const std::int64_t tick : {1, 100, 3750})
        REQUIRE(injected_count(mine, Tick{tick}) == injected_count(theirs, Tick{tick}));
      for (std::uint64_t n = 0; n < 20; ++n) {
        const InjectedBody a = injected_body(mine, n), b = injected_body(theirs, n);
        REQUIRE(a.state.position == b.state.position);
        REQUIRE(a.state.linear_velocity == b.state.linear_velocity);
        const BodyDefinition &x = world->prototypes[a.prototype.value].body,
                             &y = read->prototypes[b.prototype.value].body;
        REQUIRE(x.shape.index() == y.shape.index());
        REQUIRE(bounding_radius(x.shape) == bounding_radius(y.shape));
        REQUIRE(x.mass_kg == y.mass_kg);
        REQUIRE(x.friction == y.friction);
        REQUIRE(x.restitution == y.restitution);
        REQUIRE(x.linear_damping == y.linear_damping);
        REQUIRE(x.angular_damping == y.angular_damping);
      }
    }
  }
}
