// What four servers make of a scene is what one makes of it; where it is not, that is seen.
#include "server/experiment/oracles/single_server_oracle.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("flights, collisions, a cradle, dominoes and stacks on boundaries go as on one server") {
  for (const Comparison& c :
       compare_with_single_server(MigrationMode::adaptive, NetworkTiming{2000, 1000})) {
    INFO(c.scene << ": " << c.worst << " " << c.measure << ", allowed " << c.limit);
    CHECK(c.held());
  }
}

TEST_CASE("with naive handoffs collisions on seams and corners come to something else") {
  std::size_t seen = 0;
  for (const Comparison& c :
       compare_with_single_server(MigrationMode::naive, NetworkTiming{2000, 1000}))
    if (c.scene.find("collide") != std::string::npos && !c.held()) ++seen;
  CHECK(seen == 2);
}
