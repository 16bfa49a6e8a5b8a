// What four servers make of a scene is what one makes of it; where it is not, that is seen.
#include "server/experiment/oracles/single_server_oracle.h"
#include "tests/support/catch.h"

using namespace aureole;

TEST_CASE("flights, collisions, a cradle, dominoes and stacks on boundaries go as on one server") {
  for (const Comparison& c :
       compare_with_single_server(MigrationMode::adaptive, NetworkTiming{2000, 1000})) {
    INFO(describe(c) << "; " << c.handoffs << " handoffs, " << c.stand_ins << " stand-ins");
    CHECK(c.agrees());
    // Not one server compared with itself.
    CHECK(c.idle.empty());
    CHECK(c.handoffs > 0);
  }
}

TEST_CASE("with naive handoffs collisions on seams and corners come to something else") {
  std::size_t seen = 0;
  for (const Comparison& c :
       compare_with_single_server(MigrationMode::naive, NetworkTiming{2000, 1000}))
    if (c.scene.find("collide") != std::string::npos && !c.agrees()) {
      ++seen;
      CHECK(c.where.find("at tick") != std::string::npos);
      CHECK(c.where.find("world body") != std::string::npos);
    }
  CHECK(seen == 2);
}
