// The published aura projection, case by case: each of the scenarios of the paper's Fig. 1.
#include <array>
#include <vector>

#include "tests/unit/aura/paper/paper_servers.h"

using namespace aureole;

TEST_CASE("A and B: on either side of a boundary, naive servers never hear of the other's body") {
  Servers naive(figure_1(), MigrationMode::naive);
  naive.put('A', 0, -0.35, -20);
  naive.put('B', 1, 0.35, -20);
  naive.step(50);
  REQUIRE(naive.owner_of('A') != naive.owner_of('B'));
  REQUIRE(naive.told(0, 'A').empty());

  Servers paper(figure_1());
  paper.put('A', 0, -0.35, -20);
  paper.put('B', 1, 0.35, -20);
  paper.step(2);
  REQUIRE(paper.owner_of('A') == paper.owner_of('B'));
}

TEST_CASE("C and D: a body that enters an aura projected by another server migrates to it") {
  Servers servers(figure_1());
  servers.put('C', 0, -2, -20);
  servers.put('D', 1, -2 + enters_m + 0.1, -20);
  servers.step(10);
  REQUIRE(servers.told(0, 'C') == std::vector{1, 2});
  REQUIRE(servers.owner_of('D') == 1);
  servers.bodies[name('D')].position.x -= 0.15;
  servers.step(3);
  REQUIRE(servers.owner_of('D') == 0);
  REQUIRE(servers.changes_of('C') == 0);
}

TEST_CASE("C and D: an aura as wide as its box, but not as its sphere, has not been entered") {
  Servers servers(figure_1());
  servers.put('C', 0, -1, -20);
  servers.put('D', 1, -1 + 2.8, -20 + 2.8);  // 3.96 m away.
  servers.step(10);
  REQUIRE(servers.owner_of('D') == 1);
}

TEST_CASE("E, F and G: a chain of which one end intersects the boundary is no island") {
  Servers servers(figure_1());
  servers.put('E', 0, 0.2, -20);  // Partly still in region 0.
  servers.put('F', 0, 4, -20);
  servers.put('G', 0, 9, -20);
  servers.step(100);
  for (char letter : {'E', 'F', 'G'}) REQUIRE(servers.changes_of(letter) == 0);
  servers.bodies[name('E')].position.x = 0.4;
  servers.step(2);
  for (char letter : {'E', 'F', 'G'}) REQUIRE(servers.owner_of(letter) == 1);
}

TEST_CASE("H, I and J: an island beyond the boundary migrates whole, in one group") {
  Servers servers(figure_1());
  servers.put('H', 0, -40, 1);
  servers.put('I', 0, -36, 4);
  servers.put('J', 0, -32, 1);
  servers.step();
  REQUIRE(servers.decisions[0].leaving.size() == 1);
  REQUIRE(servers.decisions[0].leaving[0].to == RegionId{2});
  REQUIRE(servers.decisions[0].leaving[0].bodies == std::vector{name('H'), name('I'), name('J')});
  servers.step(100);
  for (char letter : {'H', 'I', 'J'}) REQUIRE(servers.changes_of(letter) == 1);
}

TEST_CASE(
    "K, L and M: a body inside the auras of two servers does not go to and fro between them") {
  for (const auto& [k, l, m] : std::vector<std::array<int, 3>>{
           {0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}, {0, 2, 1}, {1, 2, 0}}) {
    Servers servers(figure_1());
    servers.put('K', k, 0, 0).changed_owner = servers.now;
    servers.put('L', l, -3, 0).changed_owner = servers.now;
    servers.put('M', m, 3, 0).changed_owner = servers.now;
    servers.step(200);
    REQUIRE(servers.owner_of('K') == 0);
    REQUIRE(servers.owner_of('L') == 0);
    REQUIRE(servers.owner_of('M') == 0);
    for (char letter : {'K', 'L', 'M'}) REQUIRE(servers.changes_of(letter) <= 2);
  }
}

TEST_CASE("K, L and M: what overlaps the one that migrates goes along in the same group") {
  Servers servers(figure_1());
  servers.put('L', 0, -1.5, -20);
  servers.put('K', 1, 1.5, -20);
  servers.put('M', 1, 1.5 + overlaps_m - 0.1, -20);
  servers.put('P', 1, 1.5 + 2 * overlaps_m, -20);  // Just out of M's reach.
  servers.step(2);
  REQUIRE(servers.decisions[1].leaving.size() == 1);
  REQUIRE(servers.decisions[1].leaving[0].bodies == std::vector{name('K'), name('M')});
  REQUIRE(servers.owner_of('P') == 1);
}

TEST_CASE("N and O: servers whose bodies reach into a third region only hear of each other") {
  Servers servers(figure_1());
  servers.put('N', 2, -2.9, 0.5);
  servers.put('O', 1, 0.5, -2.9);
  servers.step(10);
  REQUIRE(servers.told(2, 'N') == std::vector{0, 1});
  REQUIRE(servers.told(1, 'O') == std::vector{0, 2});
  REQUIRE(servers.owner_of('N') == 2);
  servers.bodies[name('N')].position = {-2, 0.3, 0.5};
  servers.bodies[name('O')].position = {0.3, 0.3, -1.5};
  servers.step(3);
  REQUIRE(servers.owner_of('N') == servers.owner_of('O'));
}
