// The graph says of everybody at once what `touching` says of one.
#include <algorithm>

#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

std::vector<BodyId> everybody(const PhysicsWorld& world) {
  std::vector<BodyId> all(world.ids().begin(), world.ids().end());
  all.insert(all.end(), world.stand_in_ids().begin(), world.stand_in_ids().end());
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<BodyId> row(const PhysicsWorld& world, BodyId id) {
  const std::vector<BodyId> all = everybody(world);
  const auto at = std::find(all.begin(), all.end(), id);
  if (at == all.end()) return {};
  ContactGraph graph;
  world.contact_graph(all, graph);
  std::vector<BodyId> partners;
  for (std::uint32_t place : graph.touching(static_cast<std::uint32_t>(at - all.begin())))
    partners.push_back(all[place]);
  return partners;
}

std::size_t require_graph_is_touching(const PhysicsWorld& world) {
  std::size_t joined = 0;
  for (BodyId id : everybody(world)) {
    const auto found = row(world, id);
    REQUIRE(found == world.touching(id));
    joined += found.size();
  }
  return joined;
}

}  // namespace

TEST_CASE("the contact graph of a heap is what touching says of each, awake, asleep and cut") {
  PhysicsWorld world = world_on_ground();
  world.add(heap(150, 33, 4));
  for (int i = 0; i < 5; ++i) {
    run(world, 20);
    require_graph_is_touching(world);
  }
  CHECK(require_graph_is_touching(world) > 150);
  for (int i = 0; i < 1500 && world.awake_count() > 0; ++i) world.step(tick_s);
  CHECK(world.awake_count() < 10);
  CHECK(require_graph_is_touching(world) > 150);

  const std::vector<BodyId> cut(world.ids().begin() + 20, world.ids().begin() + 60);
  world.turn_into_stand_ins(cut);
  REQUIRE(everybody(world).size() == 150);
  std::size_t leaning = 0;
  for (BodyId id : cut) {
    for (BodyId other : row(world, id)) REQUIRE(!world.is_stand_in(other));
    leaning += row(world, id).size();
  }
  CHECK(leaning > 10);
  require_graph_is_touching(world);
}

TEST_CASE("sleepers that arrive with their contacts are in the graph") {
  PhysicsWorld from = world_on_ground();
  from.add(pyramid());
  run(from, 400);
  REQUIRE(from.awake_count() == 0);
  PhysicsWorld to = world_on_ground();
  to.add(bodies_of(from));
  REQUIRE(row(to, BodyId::world(0)).empty());
  to.install_contacts(from.contacts_within(from.ids()));
  CHECK(require_graph_is_touching(to) > 0);
  for (BodyId id : from.ids()) CHECK(row(to, id) == row(from, id));
}

TEST_CASE("the graph is built anew for each question and knows nothing of strangers") {
  PhysicsWorld world = world_on_ground();
  const std::vector<NewBody> tower = plain_tower();
  world.add(std::span(tower).first(3));
  CHECK(row(world, BodyId::world(0)).empty());
  run(world, 3);
  CHECK(row(world, BodyId::world(1)) == std::vector<BodyId>{BodyId::world(0), BodyId::world(2)});
  const BodyId top = BodyId::world(2);
  world.remove({&top, 1});
  CHECK(row(world, BodyId::world(1)) == std::vector<BodyId>{BodyId::world(0)});
  CHECK(row(world, top).empty());
}

TEST_CASE("of those outside its group the graph says only how many lean on whom") {
  PhysicsWorld world = world_on_ground();
  world.add(plain_tower());
  run(world, 3);
  const std::vector<BodyId> group{BodyId::world(1), BodyId::world(2), BodyId::world(4)};
  ContactGraph graph;
  world.contact_graph(group, graph);
  CHECK(std::vector(graph.touching(0).begin(), graph.touching(0).end()) ==
        std::vector<std::uint32_t>{1});
  CHECK(graph.leaning_on(0) == 2);
  CHECK(graph.leaning_on(1) == 2);
  CHECK(graph.touching(2).empty());
  CHECK(graph.leaning_on(2) == 2);
}
