// Each array construct: how many bodies, where, and how they are turned.
#include <cmath>

#include "server/worlds/reading/arrangement.h"
#include "tests/support/catch.h"
#include "tests/unit/worlds/small_world.h"

namespace aureole::test {
namespace {

const std::string brick =
    R"({ "shape": { "type": "box", "size": [0.8, 0.4, 0.2] }, "mass_kg": 1 })";

std::vector<WorldBody> made(const std::string& rest, const std::string& body = brick) {
  const auto world =
      parse_bodies(R"([ { "body": )" + body + R"(, "position": [10, 0, 20], )" + rest + " } ]");
  INFO((world ? "" : world.error().message));
  REQUIRE(world);
  return world->bodies;
}

void check_at(const WorldBody& body, double x, double y, double z) {
  INFO("at " << body.state.position.x << " " << body.state.position.y << " "
             << body.state.position.z << ", expected " << x << " " << y << " " << z);
  CHECK((body.state.position.vector() - Eigen::Vector3d(x, y, z)).norm() < 1e-5);
}

/// Where the body's own x axis points.
Eigen::Vector3f along(const WorldBody& body) {
  return body.state.orientation * Eigen::Vector3f::UnitX();
}

}  // namespace

TEST_CASE("a body without a construct is one body at its position") {
  const auto bodies = made(R"("velocity": [1, 2, 3], "spin": [4, 5, 6])");
  REQUIRE(bodies.size() == 1);
  check_at(bodies[0], 10, 0, 20);
  CHECK(bodies[0].state.linear_velocity == Eigen::Vector3f(1, 2, 3));
  CHECK(bodies[0].state.angular_velocity == Eigen::Vector3f(4, 5, 6));
}

TEST_CASE("a standing body touches the position's height, however it is turned") {
  check_at(made(R"("standing": true)")[0], 10, 0.2, 20);
  check_at(made(R"("standing": true, "body_orientation": { "roll_deg": 90 })")[0], 10, 0.4, 20);
  check_at(
      made(R"("standing": true)",
           R"({ "shape": { "type": "capsule", "radius": 0.3, "height": 2 }, "mass_kg": 1 })")[0],
      10, 1, 20);
  // A hull given from its foot up: the foot stands at the position, not the centre of mass.
  const auto cone = made(
      R"("standing": true)",
      R"({ "shape": { "type": "convex_hull", "points": [[-1,0,-1],[1,0,-1],[-1,0,1],[1,0,1],[0,2,0]] }, "mass_kg": 1 })");
  check_at(cone[0], 10, 0.5, 20);
}

TEST_CASE("a grid is centred in x and z, grows upwards, and steps by the body's size") {
  const auto bodies = made(R"("grid": { "count": [2, 2, 3] })");
  REQUIRE(bodies.size() == 12);
  check_at(bodies[0], 9.6, 0, 19.8);
  check_at(bodies[1], 10.4, 0, 19.8);
  check_at(bodies[11], 10.4, 0.4, 20.2);
}

TEST_CASE("a grid's layers can be staggered and turned") {
  const auto staggered =
      made(R"("grid": { "count": [1, 2, 1], "step": [2, 1, 4], "stagger": 0.5 })");
  check_at(staggered[1], 11, 1, 22);
  const auto turned = made(R"("grid": { "count": [1, 2, 3], "turn_deg_per_layer": 90 })");
  check_at(turned[0], 10, 0, 19.8);
  check_at(turned[3], 9.8, 0.4, 20);
  CHECK((along(turned[3]) - Eigen::Vector3f(0, 0, -1)).norm() < 1e-5f);
}

TEST_CASE("a line has a body at each point, or at equal distances along it") {
  const auto points = made(R"("line": { "points": [[0, 0, 0], [3, 0, 0], [3, 0, 5]] })");
  REQUIRE(points.size() == 3);
  check_at(points[2], 13, 0, 25);
  const auto spaced =
      made(R"("line": { "points": [[0, 0, 0], [3, 0, 0], [3, 0, 5]], "spacing": 1 })");
  REQUIRE(spaced.size() == 9);
  check_at(spaced[2], 12, 0, 20);
  check_at(spaced[5], 13, 0, 22);
  CHECK((along(spaced[1]) - Eigen::Vector3f(1, 0, 0)).norm() < 1e-5f);
  CHECK((along(spaced[5]) - Eigen::Vector3f(0, 0, 1)).norm() < 1e-5f);
}

TEST_CASE("a smooth closed line runs through its points in equal steps") {
  const std::vector<Eigen::Vector3d> square = {
      {10, 0, 10}, {-10, 0, 10}, {-10, 0, -10}, {10, 0, -10}};
  const auto places = places_along(square, {0.5, true, true});
  REQUIRE(places.size() > 120);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double step = (places[(i + 1) % places.size()].position - places[i].position).norm();
    // Chords of a curve are a little shorter than its arcs.
    CHECK(step == Approx(0.5).margin(0.02));
  }
  for (const auto& corner : square) {
    double nearest = 1e9;
    for (const Place& p : places) nearest = std::min(nearest, (p.position - corner).norm());
    CHECK(nearest < 0.26);
  }
}

TEST_CASE("a ring turns from +x towards -z, each body along its tangent") {
  const auto bodies = made(R"("ring": { "radius": 2, "count": 4, "layers": 2, "stagger": 0.5 })");
  REQUIRE(bodies.size() == 8);
  check_at(bodies[0], 12, 0, 20);
  check_at(bodies[1], 10, 0, 18);
  CHECK((along(bodies[0]) - Eigen::Vector3f(0, 0, -1)).norm() < 1e-5f);
  const double half = std::sqrt(2.0);
  check_at(bodies[4], 10 + half, 0.4, 20 - half);
  const auto arc = made(R"("ring": { "radius": 2, "count": 3, "from_deg": 0, "to_deg": 180 })");
  check_at(arc[2], 8, 0, 20);
}

TEST_CASE("every second row of a wall is a quarter of a brick further") {
  const auto bodies = made(R"("wall": { "length": 3, "rows": 3, "gap": 0.2 })");
  REQUIRE(bodies.size() == 9);
  check_at(bodies[0], 8.875, 0, 20);
  check_at(bodies[3], 9.125, 0.4, 20);
  check_at(bodies[8], 10.875, 0.8, 20);
}

TEST_CASE("a pyramid shrinks by one each layer, and a side of one stays") {
  CHECK(made(R"("pyramid": { "base": [3, 3] })").size() == 14);
  CHECK(made(R"("pyramid": { "base": [4, 4], "layers": 2 })").size() == 25);
  const auto flat = made(R"("pyramid": { "base": [3, 1], "gap": 0.2 })");
  REQUIRE(flat.size() == 6);
  check_at(flat[0], 9, 0, 20);
  check_at(flat[3], 9.5, 0.4, 20);
  check_at(flat[5], 10, 0.8, 20);
}

TEST_CASE("a construct is turned about its position as a whole") {
  const auto bodies =
      made(R"("orientation": { "yaw_deg": 90 }, "wall": { "length": 3, "rows": 1 })");
  check_at(bodies[2], 10, 0, 19.3);
  CHECK((along(bodies[2]) - Eigen::Vector3f(0, 0, -1)).norm() < 1e-5f);
}

TEST_CASE("colours go round by body or by layer, and each makes a prototype") {
  const std::string colours = R"("colour": ["#ff0000", "#00ff00"], )";
  const auto by_body = made(colours + R"("grid": { "count": [3, 1, 1] })");
  CHECK(by_body[0].prototype != by_body[1].prototype);
  CHECK(by_body[0].prototype == by_body[2].prototype);
  const auto by_layer = made(colours + R"("colour_by": "layer", "grid": { "count": [2, 2, 1] })");
  CHECK(by_layer[0].prototype == by_layer[1].prototype);
  CHECK(by_layer[0].prototype != by_layer[2].prototype);
}

}  // namespace aureole::test
