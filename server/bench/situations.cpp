// Pouring bodies until they lie as they would in a server's world.
#include "server/bench/situations.h"

#include <cmath>
#include <memory>
#include <utility>

#include "server/base/check.h"
#include "server/base/tick.h"
#include "server/experiment/random.h"
#include "server/experiment/scenario/scenario.h"
#include "server/measure/workload/workload.h"
#include "server/worlds/injector.h"

namespace aureole {
namespace {

constexpr double settling_s_max = 20;

std::vector<BodyDefinition> definitions_of(const WorldDefinition& world) {
  std::vector<BodyDefinition> all;
  for (const auto& prototype : world.prototypes) all.push_back(prototype.body);
  return all;
}

std::vector<StaticDefinition> statics_of(const WorldDefinition& world) {
  std::vector<StaticDefinition> all;
  for (const auto& piece : world.statics) all.push_back(piece.body);
  return all;
}

WorldDefinition workload_of(const BenchOptions& options, int servers) {
  WorkloadOptions o;
  o.servers = servers;
  o.seconds = options.seconds;
  o.rate_per_s = servers * options.bodies / options.seconds;
  o.seed = options.seed;
  auto world = workload_world(o);
  AUREOLE_CHECK(world, "there are one and two columns");
  return std::move(*world);
}

std::int64_t ticks_of(double seconds) {
  return static_cast<std::int64_t>(std::ceil(seconds / double{tick_s}));
}

std::vector<NewBody> bodies_of(const PhysicsWorld& physics) {
  std::vector<NewBody> bodies;
  for (BodyId id : physics.ids()) bodies.push_back({id, physics.prototype(id), physics.state(id)});
  return bodies;
}

Situation situation_of(std::string name, WorldDefinition world, PhysicsWorld& physics) {
  Situation made{std::move(name), std::move(world), bodies_of(physics),
                 physics.contacts_within(physics.ids())};
  made.world.injectors.clear();
  made.world.bodies.clear();
  return made;
}

/// Everything that the injectors make before tick `until`, as it comes.
void pour(const WorldDefinition& world, PhysicsWorld& physics, std::int64_t until) {
  std::vector<std::uint64_t> made(world.injectors.size(), 0);
  for (std::int64_t tick = 1; tick <= until; ++tick) {
    std::vector<NewBody> born;
    for (std::size_t i = 0; i < world.injectors.size(); ++i) {
      const std::uint64_t count = injected_count(world.injectors[i], Tick{tick});
      for (; made[i] < count; ++made[i]) {
        const InjectedBody body = injected_body(world.injectors[i], made[i]);
        born.push_back(
            {BodyId::injected(static_cast<std::uint16_t>(i), made[i]), body.prototype, body.state});
      }
    }
    physics.add(born);
    physics.step(tick_s);
  }
}

Situation empty_of(WorldDefinition world, std::string name) {
  world.injectors.clear();
  world.bodies.clear();
  return {std::move(name), std::move(world), {}, {}};
}

}  // namespace

Situation poured(const BenchOptions& options) {
  WorldDefinition world = workload_of(options, 1);
  SituatedWorld at(empty_of(world, ""));
  pour(world, at.physics(), ticks_of(options.seconds));
  return situation_of("workload", std::move(world), at.physics());
}

Situation settled(const BenchOptions& options) {
  Situation heap = poured(options);
  SituatedWorld at(heap);
  for (std::int64_t n = ticks_of(settling_s_max); n > 0 && at.physics().awake_count() > 0; --n)
    at.physics().step(tick_s);
  Situation made = situation_of("settled", std::move(heap.world), at.physics());
  // Somewhere in a large heap something rocks for minutes.
  for (NewBody& body : made.bodies) {
    body.state.activation = Activation::asleep;
    body.state.linear_velocity.setZero();
    body.state.angular_velocity.setZero();
  }
  return made;
}

Situation in_flight(const BenchOptions& options) {
  Situation made = empty_of(workload_of(options, 1), "flight");
  Random random(options.seed, 1);
  const int edge = static_cast<int>(std::ceil(std::cbrt(options.bodies)));
  for (int n = 0; n < options.bodies; ++n) {
    NewBody body{BodyId::world(static_cast<std::uint32_t>(n)),
                 PrototypeId{static_cast<PrototypeId::rep>(n % 3)},
                 {}};
    body.state.position = {3.0 * (n % edge), 60 + 3.0 * (n / edge % edge), 3.0 * (n / edge / edge)};
    // All alike, and enough spin that every orientation changes in every step.
    body.state.linear_velocity = {5, 0, 3};
    for (int axis = 0; axis < 3; ++axis)
      body.state.angular_velocity[axis] = static_cast<float>(random.between(1, 4));
    made.bodies.push_back(body);
  }
  return made;
}

SituatedWorld::SituatedWorld(const Situation& situation)
    : definitions_(definitions_of(situation.world)),
      statics_(statics_of(situation.world)),
      physics_(situation.world.physics, definitions_, statics_) {
  physics_.add(situation.bodies);
  physics_.install_contacts(situation.contacts);
}

WorldDefinition two_servers(const BenchOptions& options) {
  BenchOptions longer = options;
  WorldDefinition world = workload_of(longer, 2);
  // They go on coming while it is measured.
  for (Injector& injector : world.injectors)
    injector.duration_s += options.ticks * double{tick_s} + 1;
  world.max_bodies += static_cast<std::uint32_t>(options.bodies);
  return world;
}

}  // namespace aureole
