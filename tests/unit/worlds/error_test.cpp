// Each way in which a world file can be wrong, and the sentence that says so.
#include <string>
#include <vector>

#include "protocol/quantise.h"
#include "server/worlds/reading/body_reader.h"
#include "tests/support/catch.h"
#include "tests/unit/worlds/small_world.h"

namespace aureole::test {
namespace {

struct Mistake {
  std::string from, to, sentence;
};

void check(const std::vector<Mistake>& mistakes) {
  for (const Mistake& m : mistakes) {
    INFO("instead of " << m.from << " stands " << m.to);
    REQUIRE(small_world.find(m.from) != std::string::npos);
    const auto world = parse(with(small_world, m.from, m.to));
    REQUIRE_FALSE(world);
    CHECK(world.error().message == m.sentence);
  }
}

}  // namespace

TEST_CASE("the small world itself is accepted") {
  const auto world = parse(small_world);
  INFO((world ? "" : world.error().message));
  REQUIRE(world);
}

TEST_CASE("wrong types, missing keys and unknown keys are named with their JSON path") {
  check({
      {R"("max_x": 0)", R"("max_x": "abc")",
       R"(w.json: /regions/0/area/max_x: found "abc", expected a number)"},
      {R"("name": "small",)", "", R"(w.json: /: found no key "name", expected one)"},
      {R"("name": "small")", R"("name": "")",
       R"(w.json: /name: found "", expected a text of 1 to 64 bytes)"},
      {R"("name": "small")", R"("name": [])",
       R"(w.json: /name: found an array of 0 elements, expected a text)"},
      {R"("max_bodies": 50)", R"("max_bodis": 50)",
       R"(w.json: /max_bodis: found an unknown key, did you mean "max_bodies"?)"},
      {R"("mass_kg": 2)", R"("mass": 2)",
       R"(w.json: /definitions/ball/mass: found an unknown key, did you mean "mass_kg"?)"},
      {R"("min_x": 0)", R"("elephants": 0)",
       "w.json: /regions/1/area/elephants: found an unknown key, expected one of min_x, max_x, "
       "min_z, max_z"},
      {R"("name": "small")", R"("name": "small", "mode": "fast")",
       R"(w.json: /mode: found "fast", expected "naive", "paper" or "adaptive")"},
      {R"("name": "small")", R"("name": "small", "mode": 2)",
       R"(w.json: /mode: found 2, expected "naive", "paper" or "adaptive")"},
      {R"("max_bodies": 50)", R"("max_bodies": 2.5)",
       "w.json: /max_bodies: found 2.5, expected a whole number from 1 to 100000"},
      {R"("max_bodies": 50)", R"("max_bodies": 18446744073709551615)",
       "w.json: /max_bodies: found 18446744073709551615, expected a whole number from 1 to 100000"},
      {R"("position": [1, 2, 3])", R"("position": [1, 2])",
       "w.json: /bodies/0/position: found an array of 2 elements, expected an array of 3 elements"},
      {R"("position": [1, 2, 3])", R"("position": [1, 2, 3], "asleep": 1)",
       "w.json: /bodies/0/asleep: found 1, expected true or false"},
      {R"("bounds": { "min": [-100, -10, -100], "max": [100, 50, 100] })", R"("bounds": 7)",
       "w.json: /bounds: found 7, expected an object"},
      {R"([ { "position": [0, 1, 0] } ])", "[]",
       "w.json: /spawn_points: found an array of 0 elements, expected an array of 1 to 1024 "
       "elements"},
  });
}

TEST_CASE("what is no JSON is refused with its line and column") {
  check({
      {R"("max_bodies": 50)", R"("max_bodies": NaN)",
       "w.json: line 4, column 17: not JSON: syntax error while parsing value - invalid literal; "
       "last read: '\"max_bodies\": N'"},
      {R"("max_bodies": 50)", R"("max_bodies": 1e999)",
       "w.json: line 4, column 21: found the number 1e999, expected one that fits a double"},
      {R"("max_bodies": 50)", R"("max_bodies": 50, "max_bodies": 60)",
       "w.json: /max_bodies: the key is there twice, expected once"},
      {R"("max_x": 0)", R"("max_x": 0, "max_x": 1)",
       "w.json: /regions/0/area/max_x: the key is there twice, expected once"},
  });
  for (const std::string bad : {"Infinity", "-Infinity", "nan", "01", "'x'"}) {
    const auto world = parse(with(small_world, R"("max_bodies": 50)", "\"max_bodies\": " + bad));
    REQUIRE_FALSE(world);
    CHECK(world.error().message.find("w.json: line 4, column ") == 0);
  }
}

TEST_CASE("numbers out of range are refused with the range and its unit") {
  check({
      {R"("mass_kg": 2)", R"("mass_kg": -2)",
       "w.json: /definitions/ball/mass_kg: found -2, expected a number above 0 and up to 1e+06 kg"},
      {R"("mass_kg": 2)", R"("mass_kg": 0)",
       "w.json: /definitions/ball/mass_kg: found 0, expected a number above 0 and up to 1e+06 kg"},
      {R"("radius": 0.5)", R"("radius": 0)",
       "w.json: /definitions/ball/shape/radius: found 0, expected a number from 0.01 to 1000 m"},
      {R"("mass_kg": 2)", R"("mass_kg": 2, "restitution": 1.5)",
       "w.json: /definitions/ball/restitution: found 1.5, expected a number from 0 to 1"},
      {R"("rate_per_s": 10)", R"("rate_per_s": 0)",
       "w.json: /injectors/0/rate_per_s: found 0, expected a number above 0 and up to 100000 "
       "bodies/s"},
      {R"("name": "small")", R"("name": "small", "tolerances": { "speed_mps": 0 })",
       "w.json: /tolerances/speed_mps: found 0, expected a number from 0.1 to 1000 m/s"},
      {R"("name": "small")", R"("name": "small", "physics": { "solver_iterations": 51 })",
       "w.json: /physics/solver_iterations: found 51, expected a whole number from 1 to 50"},
      {"[100, 50, 100]", "[-100, 50, 100]",
       "w.json: /bounds: found bounds without a volume, expected min below max on each axis"},
      {"[100, 50, 100]", "[-101, 50, 100]",
       "w.json: /bounds: found a min above its max, expected min ≤ max on each axis"},
  });
}

TEST_CASE("bodies that cannot be are refused") {
  const std::string one = R"({ "body": "ball", "position": [1, 2, 3] })";
  check({
      {R"("body": "ball")", R"("body": "bal")",
       R"(w.json: /bodies/0/body: found "bal", expected a name from "definitions": did you mean "ball"?)"},
      {R"("body": "ball")", R"("body": 3)",
       "w.json: /bodies/0/body: found 3, expected the name of a definition, or a definition"},
      {R"("mass_kg": 2)", R"("mass_kg": 2, "density_kg_m3": 3)",
       R"(w.json: /definitions/ball: found both masses, expected either "mass_kg" or "density_kg_m3")"},
      {R"(, "mass_kg": 2)", "",
       R"(w.json: /definitions/ball: found no mass, expected either "mass_kg" or "density_kg_m3")"},
      {R"("radius": 0.5 }, "mass_kg": 2)", R"("radius": 500 }, "density_kg_m3": 1000)",
       "w.json: /definitions/ball/density_kg_m3: found a density that makes 5.23599e+11 kg, "
       "expected at most 1e+06 kg"},
      {R"("type": "sphere")", R"("type": "shpere")",
       "w.json: /definitions/ball/shape/type: found \"shpere\", expected sphere, box, capsule, "
       "cylinder, convex_hull, compound or (statics) plane: did you mean \"sphere\"?"},
      {R"({ "type": "sphere", "radius": 0.5 })", R"({ "type": "plane" })",
       R"(w.json: /definitions/ball/shape/type: found "plane", expected a shape with a volume (planes are for "statics"))"},
      {R"({ "type": "sphere", "radius": 0.5 })",
       R"({ "type": "capsule", "radius": 0.5, "height": 0.9 })",
       "w.json: /definitions/ball/shape/height: found 0.9, expected a number from 0.999999 to 1000 "
       "m"},
      {R"({ "type": "sphere", "radius": 0.5 })",
       R"({ "type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,0,1],[1,0,1]] })",
       "w.json: /definitions/ball/shape/points: found an array of 4 elements, expected points that "
       "do not all lie in one plane"},
      {R"({ "type": "sphere", "radius": 0.5 })",
       R"({ "type": "compound", "children": [ { "shape": { "type": "compound", "children": [] } } ] })",
       R"(w.json: /definitions/ball/shape/children/0/shape/type: found "compound", expected a shape that is not a compound itself)"},
      {"[1, 2, 3]", "[101, 2, 3]",
       "w.json: /bodies/0: found body 1 of 1 at (101, 2, 3) m, expected it inside the world's "
       "bounds"},
      {one, R"({ "body": "ball", "position": [0, 0, 0], "grid": { "count": [3, 6, 3] } })",
       R"(w.json: /bodies/0: found 54 bodies up to here, expected at most "max_bodies", which is 50)"},
      {one, R"({ "body": "ball", "position": [0, 0, 0], "velocity": [33, 0, 0] })",
       "w.json: /bodies/0/velocity: found a speed of 33 m/s, expected at most the speed tolerance "
       "of 32 m/s"},
      {one, R"({ "body": "ball", "position": [0, 0, 0], "velocity": [1, 0, 0], "asleep": true })",
       "w.json: /bodies/0/asleep: found a body that is asleep and moves, expected one or the "
       "other"},
      {one, R"({ "body": "ball", "position": [0, 0, 0], "host": "north" })",
       R"(w.json: /bodies/0/host: found "north", expected the name of a region)"},
      {one, R"({ "body": "ball", "position": [0, 0, 0], "colour": "#12345g" })",
       R"(w.json: /bodies/0/colour: found "#12345g", expected a colour like "#c0ffee")"},
      {one,
       R"({ "body": "ball", "position": [0, 0, 0], "orientation": { "quaternion": [0, 0, 0, 0.5] } })",
       "w.json: /bodies/0/orientation/quaternion: found a quaternion of length 0.5, expected 1 "
       "within 0.001"},
      {one,
       R"({ "body": "ball", "position": [0, 0, 0], "orientation": { "yaw_deg": 3, "quaternion": [0, 0, 0, 1] } })",
       "w.json: /bodies/0/orientation: found an object, expected either angles or a quaternion"},
      {one,
       R"({ "body": "ball", "position": [0, 0, 0], "wall": { "length": 2, "rows": 2 }, "grid": { "count": [1, 1, 1] } })",
       R"(w.json: /bodies/0/wall: found a second construct beside "grid", expected one at most)"},
      {one,
       R"({ "body": "ball", "position": [0, 0, 0], "grid": { "count": [10000, 10000, 10000] } })",
       "w.json: /bodies/0/grid: found a construct of 1000000000000 bodies, expected at most "
       "100000"},
      {R"("position": [0, 0, 0] } ],)",
       R"("position": [0, 0, 0], "orientation": { "roll_deg": 3 } } ],)",
       "w.json: /statics/0/orientation: found a plane that is turned, expected none: planes are "
       "horizontal"},
      {"[0, 5, 0]", "[0, -11, 0]",
       "w.json: /injectors/0/volume: found a volume that reaches outside the world's bounds, "
       "expected one inside"},
      {R"("position": [0, 1, 0])", R"("position": [0, 1, 200])",
       "w.json: /spawn_points/0/position: found a spawn point outside the world's bounds, expected "
       "one inside"},
  });
}

TEST_CASE("names that are there twice are refused") {
  check({
      {R"("name": "east")", R"("name": "west")",
       R"(w.json: /regions/1/name: found "west", expected a name that no other region has)"},
      {R"([ { "name": "ground", "shape": { "type": "plane" }, "position": [0, 0, 0] } ])",
       R"([ { "name": "g", "shape": { "type": "plane" }, "position": [0, 0, 0] }, { "name": "g", "shape": { "type": "plane" }, "position": [0, 0, 0] } ])",
       R"(w.json: /statics/1/name: found "g", expected a name that no other static has)"},
      {R"([ { "body": "ball", "position": [1, 2, 3] } ])",
       R"([ { "name": "a", "body": "ball", "position": [1, 2, 3] }, { "name": "a", "body": "ball", "position": [1, 2, 3] } ])",
       R"(w.json: /bodies/1/name: found "a", expected a name that no other entry of "bodies" has)"},
      {R"("injectors": [)",
       R"("injectors": [ { "name": "rain", "rate_per_s": 1, "volume": { "min": [0, 5, 0], "max": [1, 6, 1] }, "mix": [ { "body": "ball" } ] },)",
       R"(w.json: /injectors/1/name: found "rain", expected a name that no other injector has)"},
  });
}

TEST_CASE("regions that overlap, leave a gap, are empty or too narrow are refused") {
  check({
      {R"("max_x": 0)", R"("max_x": 5)",
       R"(w.json: /regions: regions "west" and "east" overlap by an infinite area around x = 2.5 m, z = 0 m, expected each point in exactly one region)"},
      {R"("max_x": 0)", R"("max_x": -4)",
       "w.json: /regions: no region covers the point x = -2 m, z = 0 m, expected each point in "
       "exactly one region (a side that is left out reaches to infinity)"},
      {R"({ "min_x": 0 })", R"({ "min_x": 0, "max_x": 0 })",
       "w.json: /regions/1/area: found a min that is not below its max, expected an area that is "
       "not empty"},
      {R"({ "name": "east", "area": { "min_x": 0 } })",
       R"({ "name": "middle", "area": { "min_x": 0, "max_x": 14 } }, { "name": "east", "area": { "min_x": 14 } })",
       R"(w.json: /regions/1: region "middle" is 14 m wide, expected at least 14.33 m (4 aura radii of 3.582 m of the largest body, "plank"))"},
  });
}

TEST_CASE("throwables: four of them, with different names, below the speed tolerance") {
  const auto four = [](const std::string& last) {
    std::string list;
    for (const char* name : {"a", "b", "c"}) {
      list += std::string(R"({ "name": ")") + name + R"(", "body": "ball", "speed_mps": 20 }, )";
    }
    return R"("name": "small", "throwables": [ )" + list + last + " ]";
  };
  check({
      {R"("name": "small")", R"("name": "small", "throwables": [])",
       "w.json: /throwables: found an array of 0 elements, expected an array of 4 elements"},
      {R"("name": "small")", four(R"({ "name": "a", "body": "ball", "speed_mps": 20 })"),
       R"(w.json: /throwables/3/name: found "a", expected a name that no other throwable has)"},
      {R"("name": "small")", four(R"({ "name": "d", "body": "ball", "speed_mps": 33 })"),
       "w.json: /throwables/3/speed_mps: found 33, expected a number above 0 and up to 32 m/s (the "
       "speed tolerance)"},
  });
}

TEST_CASE("a file that is not there is answered with the worlds that are shipped") {
  const auto world = load_world("playgruond");
  REQUIRE_FALSE(world);
  CHECK(world.error().message ==
        "playgruond: found no such file, expected a world file or the name of a shipped world "
        "(columns-4, corner-3, corner-4, "
        "corner-9, playground): did you mean \"playground\"?");
  const auto folder = load_world("/tmp");
  REQUIRE_FALSE(folder);
  CHECK(folder.error().message ==
        "/tmp: found something that is not a plain file, expected a world file");
  REQUIRE_FALSE(load_world(""));
}

TEST_CASE("bounds end where positions can no longer be told to other servers") {
  REQUIRE(bounds_m.max == position_limit_m);
  check({{R"("max": [100, 50, 100])", R"("max": [8193, 50, 100])",
          "w.json: /bounds/max/0: found 8193, expected a number from -8192 to 8192 m"}});
}

TEST_CASE("a mass that single precision does not hold is refused") {
  check({{R"("mass_kg": 2)", R"("mass_kg": 1e-60)",
          "w.json: /definitions/ball/mass_kg: found 1e-60 kg, expected at least 1e-06 kg"},
         {R"("mass_kg": 2)", R"("density_kg_m3": 1e-60)",
          "w.json: /definitions/ball/density_kg_m3: found a density that makes 5.23599e-61 kg, "
          "expected at least 1e-06 kg"}});
}

TEST_CASE("what a file says in control characters does not reach the terminal") {
  const auto world = parse(with(small_world, R"("name": "small")", R"("\u001b[2J": 1)"));
  REQUIRE_FALSE(world);
  REQUIRE(world.error().message.find('\x1b') == std::string::npos);
}

}  // namespace aureole::test
