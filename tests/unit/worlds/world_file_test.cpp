// What a world is after reading: completed, merged, hashed, split.
#include <fstream>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/unit/worlds/small_world.h"

namespace aureole::test {
namespace {

std::uint64_t hash_with(const std::string& from, const std::string& to) {
  REQUIRE(small_world.find(from) != std::string::npos);
  const auto world = parse(with(small_world, from, to));
  INFO((world ? "" : world.error().message));
  REQUIRE(world);
  return world->hash;
}

}  // namespace

TEST_CASE("what a file leaves out is completed with defaults") {
  const auto world = parse(small_world);
  REQUIRE(world);
  CHECK(world->tolerances.speed_mps == 32);
  CHECK(world->physics.gravity.y() == -9.81f);
  CHECK(world->throwables[0].name == "rubber ball");
  CHECK(world->throwables[3].name == "plank");
  const BodyDefinition& avatar = world->prototypes[world->avatar.value].body;
  CHECK(avatar.upright);
  CHECK(avatar.friction == 0);
  CHECK(avatar.mass_kg == 80);
  CHECK(std::get<CapsuleShape>(avatar.shape).height == 1.8f);
  CHECK(std::get<CapsuleShape>(avatar.shape).radius == 0.35f);
  CHECK(world->regions[0].area.min_x == -std::numeric_limits<double>::infinity());
}

TEST_CASE("equal bodies are one prototype, however they are written") {
  const auto world = parse_bodies(R"([ { "body": "ball", "position": [0, 0, 0] },
    { "body": { "mass_kg": 2.0, "friction": 0.5, "shape": { "radius": 0.5, "type": "sphere" } }, "position": [1, 0, 0] },
    { "body": "ball", "colour": "#010203", "position": [2, 0, 0] } ])");
  REQUIRE(world);
  CHECK(world->bodies[0].prototype == world->bodies[1].prototype);
  CHECK(world->bodies[0].prototype != world->bodies[2].prototype);
  CHECK(world->prototypes.size() == 2 + 4 + 1);
}

TEST_CASE("the hash is of the world, not of its text") {
  const std::uint64_t hash = parse(small_world)->hash;
  CHECK(hash_with(R"("radius": 0.5)", R"( "radius" : 5e-1)") == hash);
  CHECK(hash_with(R"("max_x": 0 )", R"("max_x": -0.0 )") == hash);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {R"("name": "small")", R"("name": "smell")"},
           {R"("radius": 0.5)", R"("radius": 0.5001)"},
           {R"("mass_kg": 2)", R"("mass_kg": 2.5)"},
           {"[1, 2, 3]", "[1, 2, 3.0001]"},
           {"[100, 50, 100]", "[100, 51, 100]"},
           {R"("max_bodies": 50)", R"("max_bodies": 51)"},
           {R"("name": "west")", R"("name": "vest")"},
           {R"("rate_per_s": 10)", R"("rate_per_s": 11)"},
           {R"("rate_per_s": 10)", R"("rate_per_s": 10, "seed": 2)"},
           {R"("rate_per_s": 10)", R"("rate_per_s": 10, "duration_s": 9)"},
           {R"("position": [0, 1, 0])", R"("position": [0, 2, 0])"},
           {R"("position": [0, 1, 0])", R"("position": [0, 1, 0], "yaw_deg": 1)"},
           {R"("position": [1, 2, 3])", R"("position": [1, 2, 3], "asleep": true)"},
           {R"("position": [1, 2, 3])", R"("position": [1, 2, 3], "host": "west")"},
           {R"("position": [1, 2, 3])", R"("position": [1, 2, 3], "velocity": [0, 0, 1])"},
           {R"("type": "plane" })", R"("type": "plane" }, "friction": 0.6)"},
           {R"("name": "small")", R"("name": "small", "physics": { "solver_iterations": 11 })"},
           {R"("name": "small")", R"("name": "small", "tolerances": { "latency_ms": 3 })"},
           {R"("name": "small")", R"("name": "small", "mode": "paper")"},
           {R"("name": "small")", R"("name": "small", "avatar": { "mass_kg": 81 })"}}) {
    INFO(to);
    CHECK(hash_with(from, to) != hash);
  }
  CHECK(parse(small_world, {4})->hash != parse(small_world, {2})->hash);
}

TEST_CASE("the mode is adaptive unless the file says otherwise, and --mode has the last word") {
  REQUIRE(parse(small_world)->mode == MigrationMode::adaptive);
  const std::string paper =
      with(small_world, R"("name": "small")", R"("name": "small", "mode": "paper")");
  REQUIRE(parse(paper)->mode == MigrationMode::paper);
  const auto naive = parse(paper, {{}, MigrationMode::naive});
  REQUIRE(naive->mode == MigrationMode::naive);
  // Servers of different modes refuse each other; it does not matter where the mode comes from.
  REQUIRE(naive->hash != parse(paper)->hash);
  REQUIRE(parse(paper, {{}, MigrationMode::adaptive})->hash == parse(small_world)->hash);
}

TEST_CASE("a split replaces the regions over bounds or extent, and hosts go with them") {
  const std::string hosted =
      with(small_world, R"("position": [1, 2, 3])", R"("position": [1, 2, 3], "host": "west")");
  REQUIRE(parse(hosted)->bodies[0].host == RegionId{0});
  const auto world = parse(hosted, {9});
  REQUIRE(world);
  CHECK(world->regions.size() == 9);
  CHECK(world->regions[4].area.max_x == Approx(100.0 / 3));
  CHECK_FALSE(world->bodies[0].host);
  const auto narrow = parse(
      with(hosted, R"("name": "small")",
           R"("name": "small", "extent": { "min_x": 0, "max_x": 60, "min_z": 0, "max_z": 60 })"),
      {3});
  REQUIRE(narrow);
  CHECK(narrow->regions[1].area.min_x == 20);
}

TEST_CASE("a split into regions that are too narrow says how many would fit") {
  const auto world = parse(small_world, {20});
  REQUIRE_FALSE(world);
  CHECK(world.error().message ==
        "w.json: /regions: 20 regions would be 10 m wide, expected at least 14.33 m (4 aura radii "
        "of 3.582 m of the largest "
        "body, \"plank\"): at most 13 regions fit");
  CHECK(parse(small_world, {13}));
  CHECK_FALSE(parse(small_world, {14}));
  CHECK_FALSE(parse(small_world, {0}));
  CHECK_FALSE(parse(small_world, {65}));
}

TEST_CASE(
    "a capsule's body stays where it was put, an uneven compound's moves to its centre of mass") {
  const auto world =
      parse_bodies(R"([ { "body": { "mass_kg": 1, "shape": { "type": "compound", "children": [
      { "shape": { "type": "box", "size": [1, 1, 1] } }, { "shape": { "type": "box", "size": [1, 1, 1] }, "position": [2, 0, 0] } ] } },
    "position": [5, 0, 0], "orientation": { "yaw_deg": 90 } } ])");
  REQUIRE(world);
  CHECK((world->bodies[0].state.position.vector() - Eigen::Vector3d(5, 0, -1)).norm() < 1e-6);
  const auto& compound =
      std::get<CompoundShape>(world->prototypes[world->bodies[0].prototype.value].body.shape);
  CHECK(compound.children[0].position == Eigen::Vector3f(-1, 0, 0));
  CHECK(compound.children[1].position == Eigen::Vector3f(1, 0, 0));
}

TEST_CASE("the example in the docs is a world") {
  std::ifstream in(AUREOLE_SOURCE_DIR "/docs/worlds.md");
  std::stringstream page;
  page << in.rdbuf();
  const std::string text = page.str();
  const auto begin = text.find("```json\n");
  REQUIRE(begin != std::string::npos);
  const auto end = text.find("```", begin + 8);
  const auto world = parse(text.substr(begin + 8, end - begin - 8));
  INFO((world ? "" : world.error().message));
  REQUIRE(world);
  CHECK(world->regions.size() == 2);
  CHECK(world->bodies.size() == 40 + 14);
}

}  // namespace aureole::test
