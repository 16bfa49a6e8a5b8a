// Bodies as they are found in a server's world: what the scenes begin with.
#pragma once

#include <string>
#include <vector>

#include "server/bench/bench.h"
#include "server/physics/physics_world.h"
#include "server/worlds/world.h"

namespace aureole {

/// Bodies with the contacts among them and with the ground, to be put into any world that has the
/// definition's prototypes and statics.
struct Situation {
  std::string name;
  WorldDefinition world;  ///< One region, without bodies and injectors.
  std::vector<NewBody> bodies;
  std::vector<ContactManifold> contacts;
};

/// The paper's workload after `seconds`, in which `bodies` have come, on one server: some fall,
/// some roll, most lie in heaps of which a part sleeps.
Situation poured(const BenchOptions& options);
/// A heap that has come to rest: everything sleeps.
Situation settled(const BenchOptions& options);
/// Everything in the air, 3 m apart, moving and spinning; nothing touches for two seconds.
Situation in_flight(const BenchOptions& options);

/// A world of its own with a situation's bodies in it.
class SituatedWorld {
 public:
  explicit SituatedWorld(const Situation& situation);
  PhysicsWorld& physics() { return physics_; }

 private:
  std::vector<BodyDefinition> definitions_;
  std::vector<StaticDefinition> statics_;
  PhysicsWorld physics_;
};

/// The paper's workload on two servers side by side, so that about `bodies` have come to each of
/// them after `seconds`.
WorldDefinition two_servers(const BenchOptions& options);

}  // namespace aureole
