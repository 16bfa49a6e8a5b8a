// The world that the gateway's tests share.
#include "tests/unit/gateway/support/small_world.h"

#include <string>
#include <utility>

namespace aureole::test {

WorldDefinition small_world(double spawn_x) {
  WorldDefinition world;
  world.name = "small";
  world.description = "For tests";
  world.hash = 42;
  Rectangle west, east;
  west.max_x = east.min_x = 0;
  world.regions = {{"west", west}, {"east", east}};
  world.bounds = {{-100, -10, -100}, {100, 100, 100}};
  const auto body = [](Shape shape, float mass_kg) {
    BodyDefinition definition;
    definition.shape = std::move(shape);
    definition.mass_kg = mass_kg;
    return definition;
  };
  const Shape box = BoxShape{{0.5f, 0.5f, 0.5f}};
  world.prototypes = {{"avatar", body(CapsuleShape{0.3f, 1.8f}, 70), {250, 250, 250}},
                      {"ball", body(SphereShape{0.3f}, 2), {220, 60, 50}},
                      {"crate", body(box, 20), {180, 140, 90}},
                      {"rock", body(box, 500), {120, 120, 120}}};
  StaticDefinition ground;
  StaticDefinition wall;
  wall.shape = BoxShape{{0.1f, 2, 4}};
  wall.position = {-20, 2, 0};
  world.statics = {{"ground", ground, {126, 148, 138}}, {"wall", wall, {90, 90, 110}}};
  world.spawn_points = {{{spawn_x, 1, 0}, 0}};
  for (Throwable& throwable : world.throwables) throwable = {"ball", ball_kind, 20};
  world.avatar = avatar_kind;
  return world;
}

WorldDefinition small_world_with_corner() {
  WorldDefinition world = small_world();
  const Rectangle west = world.regions[0].area, east = world.regions[1].area;
  world.regions.clear();
  for (const bool south : {false, true})
    for (const auto& [name, area] : {std::pair("west", west), std::pair("east", east)}) {
      Rectangle part = area;
      (south ? part.min_z : part.max_z) = 0;
      world.regions.push_back({std::string(south ? "south-" : "north-") + name, part});
    }
  return world;
}

}  // namespace aureole::test
