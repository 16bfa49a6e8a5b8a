// Spines against shapes as they stand, turned every way.
#include <limits>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

TEST_CASE("no shape stands lower over a plane than its spine says, and most can lie as low") {
  constexpr int turns = 24;
  constexpr float turn = 6.2831853f / turns;
  for (std::uint16_t kind = 0; kind < avatar; ++kind) {
    PhysicsWorld world(PhysicsSettings{}, prototypes(), {}, turns * turns);
    const float lowest = spine(prototypes()[kind].shape).lowest;
    float least = std::numeric_limits<float>::infinity();
    for (int x = 0; x < turns; ++x) {
      for (int z = 0; z < turns; ++z) {
        NewBody b = body(static_cast<std::uint32_t>(turns * x + z), kind, 0, 0, 0);
        b.state.orientation =
            Eigen::AngleAxisf(turn * static_cast<float>(x), Eigen::Vector3f::UnitX()) *
            Eigen::AngleAxisf(turn * static_cast<float>(z), Eigen::Vector3f::UnitZ());
        world.add({&b, 1});
        least = std::min(least, world.half_extents(b.id).y());
      }
    }
    INFO("shape " << kind << ": " << least << " m, said " << lowest);
    CHECK(least >= lowest - 1e-4f);
    if (kind != hull && kind != compound) CHECK(least < lowest + 0.01f);
  }
}
