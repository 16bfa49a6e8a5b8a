// The published aura projection where the paper's text leaves something open.
#include <random>

#include "tests/unit/aura/paper/paper_servers.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("two servers that see each other's aura entered at once do not swap their bodies") {
  Servers servers(figure_1());
  servers.put('C', 0, -0.5, -20);
  servers.put('D', 1, 0.5, -20);
  servers.step();
  const auto low = servers.look(0), high = servers.look(1);
  REQUIRE(low.leaving.empty());
  REQUIRE(low.pulls.empty());  // D's server knows of C: no need to ask.
  REQUIRE(high.leaving.size() == 1);
  REQUIRE(high.leaving[0].to == RegionId{0});
  servers.step(100);
  REQUIRE(servers.changes_of('C') + servers.changes_of('D') == 1);
}

TEST_CASE(
    "a chain over three regions comes together on one server, each body moving twice at most") {
  Servers servers(PartitionMap({{-inf, -inf, 12, inf}, {12, -inf, 24, inf}, {24, -inf, inf, inf}}));
  for (int n = 0; n < 10; ++n)
    servers.put(static_cast<char>('a' + n), n < 3 ? 0 : n < 7 ? 1 : 2, 3 * n + 4.5, 0);
  servers.step(200);
  for (int n = 0; n < 10; ++n) {
    REQUIRE(servers.owner_of(static_cast<char>('a' + n)) == 0);
    REQUIRE(servers.changes_of(static_cast<char>('a' + n)) <= 2);
  }
}

TEST_CASE("a body deep at home is told to the server whose visiting body comes near") {
  for (const int visitor : {1, 2}) {
    const int host = 3 - visitor;
    Servers servers(figure_1());
    const double x = host == 1 ? 40 : -40, z = host == 1 ? -40 : 40;
    servers.put('V', visitor, x, z);
    servers.bodies[name('V')].changed_owner = servers.now;
    servers.put('b', host, x + 4, z);
    servers.step(2);
    REQUIRE(servers.told(host, 'b') == std::vector{visitor});
    servers.bodies[name('b')].position.x = x + 3;
    servers.step(3);
    REQUIRE(servers.owner_of('V') == 1);
    REQUIRE(servers.owner_of('b') == 1);
  }
}

TEST_CASE("the lower server asks for a visitor whose server cannot know whom it has come upon") {
  Servers servers(figure_1());
  servers.put('b', 0, -40, -40);
  servers.put('V', 1, -39, -40);
  servers.bodies[name('V')].changed_owner = servers.now;
  servers.step(2);
  REQUIRE(servers.decisions[0].pulls.size() == 1);
  REQUIRE(servers.decisions[0].pulls[0].from == RegionId{1});
  REQUIRE(servers.decisions[0].pulls[0].bodies == std::vector{name('V')});
  servers.step(1);
  REQUIRE(servers.owner_of('V') == 0);
}

TEST_CASE("who is asked for a body hands over its whole cluster, but never to a higher number") {
  Servers servers(figure_1());
  servers.put('a', 1, 40, -40);
  servers.put('b', 1, 44, -40);
  servers.asked[1] = {{name('a'), RegionId{2}}, {name('z'), RegionId{0}}};
  REQUIRE(servers.look(1).leaving.empty());
  servers.asked[1] = {{name('a'), RegionId{0}}};
  const auto decision = servers.look(1);
  REQUIRE(decision.leaving.size() == 1);
  REQUIRE(decision.leaving[0].bodies == std::vector{name('a'), name('b')});
}

TEST_CASE("an aura covers whatever its body may do: it has one size, asleep or fast") {
  Servers servers(figure_1());
  servers.put('a', 0, -1, -20).asleep = true;
  servers.put('b', 0, -1, -60).motion_speed_mps = 30;
  const auto decision = servers.look(0);
  REQUIRE(decision.projected.size() == 2);
  for (const auto& aura : decision.projected) REQUIRE(aura.room.girth_m == Approx(2.86));
  REQUIRE(decision.projected[0].asleep);
}

TEST_CASE("an aura is projected while it intersects a boundary, and no longer") {
  Servers servers(figure_1());
  servers.put('a', 0, -2.85, -20);
  servers.step();
  REQUIRE(servers.told(0, 'a') == std::vector{1, 2});
  servers.bodies[name('a')].position.x = -2.87;
  servers.step();
  REQUIRE(servers.told(0, 'a').empty());
}

TEST_CASE(
    "an island stays while another server's aura touches it, unless it goes there downwards") {
  Servers up(figure_1());
  up.put('V', 1, 30, 20).changed_owner = up.now;  // Of server 1, in region 2.
  up.put('b', 2, 34, 20);                         // Not entered, but near.
  up.step(100);
  REQUIRE(up.changes_of('V') == 0);
  up.bodies[name('b')].position.x = 40;
  up.step(3);
  REQUIRE(up.owner_of('V') == 2);

  Servers down(figure_1());
  down.put('V', 2, 30, -20).changed_owner = down.now;
  down.put('b', 1, 34, -20);
  down.step(stay_ticks);
  REQUIRE(down.changes_of('V') == 0);
  down.step();
  REQUIRE(down.owner_of('V') == 1);
}

TEST_CASE("an island stays half a second with whoever it has come to") {
  Servers servers(figure_1());
  servers.put('V', 0, 30, -20).changed_owner = servers.now - (stay_ticks - 1);
  servers.step();
  REQUIRE(servers.changes_of('V') == 0);
  servers.step();
  REQUIRE(servers.owner_of('V') == 1);
}

TEST_CASE("an island over two regions goes where most of it is, on a tie to the lower number") {
  Servers servers(figure_1());
  servers.put('a', 0, 30, -1);
  servers.put('b', 0, 30, 2);
  REQUIRE(servers.look(0).leaving[0].to == RegionId{1});
  servers.put('c', 0, 30, 4);
  REQUIRE(servers.look(0).leaving[0].to == RegionId{2});
}

TEST_CASE("what is carried goes with its carrier, and holds it back as well") {
  Servers servers(figure_1());
  servers.put('a', 0, 30, -20);
  servers.put('t', 0, -30, -20).leader = name('a');
  servers.step();
  REQUIRE_FALSE(servers.anything_moves());
  servers.bodies[name('t')].position.x = 22;  // No longer at home.
  servers.step();
  REQUIRE(servers.owner_of('a') == 1);
  REQUIRE(servers.owner_of('t') == 1);
}

TEST_CASE("where a carried thing enters another server's aura, its carrier goes as well") {
  Servers servers(figure_1());
  servers.put('C', 0, -2, -20);
  servers.put('t', 1, 1, -20).leader = name('a');
  servers.put('a', 1, 9, -20);
  servers.step(2);
  REQUIRE(servers.owner_of('t') == 0);
  REQUIRE(servers.owner_of('a') == 0);
}

TEST_CASE("a server without a link is told nothing and handed nothing") {
  Servers servers(figure_1());
  servers.linked[1] = false;
  servers.put('a', 0, -1, -20);
  servers.put('V', 0, 30, -20);
  servers.step();
  REQUIRE(servers.told(0, 'a') == std::vector{2});
  REQUIRE_FALSE(servers.anything_moves());
  servers.linked[1] = true;
  servers.step();
  REQUIRE(servers.owner_of('V') == 1);
}

TEST_CASE("however bodies lie around a corner, they come to rest with all that they may touch") {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    Servers servers(figure_1());
    for (int n = 0; n < 30; ++n)
      servers.put(static_cast<char>('A' + n), static_cast<int>(random() % 3), between(-25, 25),
                  between(-25, 25));
    servers.step(120);
    for (int n = 0; n < 30; ++n) {
      servers.step();
      REQUIRE_FALSE(servers.anything_moves());
    }
    for (const auto& [a, first] : servers.bodies) {
      REQUIRE(servers.changes[a] <= 4);
      for (const auto& [b, second] : servers.bodies) {
        const double apart = (first.position.vector() - second.position.vector()).norm();
        if (apart <= enters_m - 0.001) REQUIRE(servers.owner[a] == servers.owner[b]);
      }
    }
  }
}
