// The published aura projection, case by case: each of the scenarios of the paper's Fig. 1, and
// what its text leaves open.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "server/aura/migration_policy.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
/// Balls of 0.3 m: with the paper's tolerances an aura of 2.86 m. A body enters another's aura
/// below 3.16 m between the centres; auras overlap below 5.72 m.
constexpr double enters_m = 3.16, overlaps_m = 5.72;

constexpr BodyId name(char letter) {
  return BodyId::world(static_cast<std::uint32_t>(letter));
}

/// As in Fig. 1: servers 0 and 1 side by side, server 2 below both; they meet in a T at the origin.
PartitionMap figure_1() {
  return PartitionMap({{-inf, -inf, 0, 0}, {0, -inf, inf, 0}, {-inf, 0, inf, inf}});
}

/// Servers that each decide once a tick, over links that take one tick.
struct Servers {
  explicit Servers(PartitionMap areas, MigrationMode mode = MigrationMode::paper)
      : map(std::move(areas)), heard(map.size()), asked(map.size()), linked(map.size(), true) {
    for (std::size_t i = 0; i < map.size(); ++i)
      policies.push_back(make_policy(mode, AuraTolerances{}));
  }

  PartitionMap map;
  std::map<BodyId, HostedBody> bodies;
  std::map<BodyId, int> owner;
  std::map<BodyId, int> changes;
  std::vector<std::unique_ptr<MigrationPolicy>> policies;
  std::vector<std::map<BodyId, RemoteAura>> heard;
  std::vector<std::vector<HandoverRequest>> asked;
  std::vector<bool> linked;
  Tick now{1000};
  /// Of the last step, by server.
  std::vector<MigrationDecision> decisions;

  HostedBody& put(char letter, int server, double x, double z) {
    HostedBody body;
    body.id = name(letter);
    body.position = {x, 0.3, z};
    body.half_extents = {0.3, 0.3, 0.3};
    body.bounding_radius_m = 0.3;
    owner[body.id] = server;
    return bodies[body.id] = body;
  }

  MigrationDecision look(int server) {
    const auto self = static_cast<std::size_t>(server);
    std::vector<HostedBody> hosted;
    for (const auto& [id, body] : bodies)
      if (owner[id] == server) hosted.push_back(body);
    std::vector<RemoteAura> remote;
    for (const auto& [id, aura] : heard[self]) remote.push_back(aura);
    return policies[self]->decide({now, RegionId{static_cast<std::uint16_t>(server)}, map, hosted,
                                   remote, asked[self], linked});
  }

  void step(int ticks = 1) {
    for (int n = 0; n < ticks; ++n) {
      decisions.clear();
      for (std::size_t i = 0; i < map.size(); ++i) decisions.push_back(look(static_cast<int>(i)));
      for (std::size_t i = 0; i < map.size(); ++i) heard[i].clear(), asked[i].clear();
      for (std::size_t i = 0; i < map.size(); ++i) tell(i);
      now = now + 1;
    }
  }

  int owner_of(char letter) { return owner.at(name(letter)); }
  int changes_of(char letter) { return changes[name(letter)]; }
  /// To whom server `server` told of the body in the last step.
  std::vector<int> told(int server, char letter) const {
    std::vector<int> to;
    for (const ProjectedAura& aura : decisions[static_cast<std::size_t>(server)].projected)
      if (aura.id == name(letter))
        aura.to.for_each([&](RegionId region) { to.push_back(region.value); });
    return to;
  }
  bool anything_moves() const {
    return std::any_of(decisions.begin(), decisions.end(),
                       [](const MigrationDecision& d) { return !d.leaving.empty(); });
  }

 private:
  void tell(std::size_t from) {
    const RegionId self{static_cast<std::uint16_t>(from)};
    for (const ProjectedAura& aura : decisions[from].projected)
      aura.to.for_each([&](RegionId to) {
        RemoteAura told;
        told.id = aura.id;
        told.host = self;
        told.room = aura.room;
        told.asleep = aura.asleep;
        heard[to.value].try_emplace(aura.id, told);
      });
    for (const Pull& pull : decisions[from].pulls)
      for (BodyId id : pull.bodies) asked[pull.from.value].push_back({id, self});
    for (const Migration& migration : decisions[from].leaving)
      for (BodyId id : migration.bodies) {
        REQUIRE(owner[id] == static_cast<int>(from));  // Also: nothing leaves twice.
        owner[id] = migration.to.value;
        bodies[id].changed_owner = now;
        ++changes[id];
      }
  }
};

}  // namespace

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
