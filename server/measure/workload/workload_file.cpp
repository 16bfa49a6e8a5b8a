// Written in the order of world.schema.json.
#include "server/measure/workload/workload_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/base/check.h"

namespace aureole {
namespace {

using nlohmann::json;

json vector_of(const Eigen::Vector3d& v) {
  return json::array({v.x(), v.y(), v.z()});
}

/// Sides without end are left out.
json area_of(const Rectangle& area) {
  json all = json::object();
  const auto add = [&](const char* key, double value) {
    if (std::isfinite(value)) all[key] = value;
  };
  add("min_x", area.min_x);
  add("max_x", area.max_x);
  add("min_z", area.min_z);
  add("max_z", area.max_z);
  return all;
}

json shape_of(const Shape& shape) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return {{"type", "sphere"}, {"radius", sphere->radius}};
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return {{"type", "box"}, {"size", vector_of(2 * box->half_extents.cast<double>())}};
  const auto* capsule = std::get_if<CapsuleShape>(&shape);
  AUREOLE_CHECK(capsule != nullptr, "a workload has spheres, boxes and capsules");
  return {{"type", "capsule"}, {"radius", capsule->radius}, {"height", capsule->height}};
}

json body_of(const Prototype& prototype) {
  const BodyDefinition& body = prototype.body;
  return {{"shape", shape_of(body.shape)},
          {"mass_kg", body.mass_kg},
          {"friction", body.friction},
          {"restitution", body.restitution}};
}

json injector_of(const Injector& injector, const WorldDefinition& world) {
  json mix = json::array();
  for (const Injector::Share& share : injector.mix)
    mix.push_back(
        {{"body", world.prototypes[share.prototype.value].name}, {"weight", share.weight}});
  return {{"name", injector.name},
          {"rate_per_s", injector.rate_per_s},
          {"volume",
           {{"min", vector_of(injector.volume.min)}, {"max", vector_of(injector.volume.max)}}},
          {"velocity",
           {{"min", vector_of(injector.velocity_min.cast<double>())},
            {"max", vector_of(injector.velocity_max.cast<double>())}}},
          {"mix", std::move(mix)},
          {"seed", injector.seed},
          {"start_s", injector.start_s},
          {"duration_s", injector.duration_s}};
}

}  // namespace

json workload_file(const WorldDefinition& world) {
  json definitions = json::object(), regions = json::array(), injectors = json::array();
  for (const Injector& injector : world.injectors) {
    injectors.push_back(injector_of(injector, world));
    for (const Injector::Share& share : injector.mix) {
      const Prototype& prototype = world.prototypes[share.prototype.value];
      definitions[prototype.name] = body_of(prototype);
    }
  }
  for (const RegionDefinition& region : world.regions)
    regions.push_back({{"name", region.name}, {"area", area_of(region.area)}});
  return {{"name", world.name},
          {"mode", name_of(world.mode)},
          {"tolerances",
           {{"speed_mps", world.tolerances.speed_mps},
            {"latency_ms", world.tolerances.latency_ms},
            {"frame_time_ms", world.tolerances.frame_time_ms}}},
          {"bounds", {{"min", vector_of(world.bounds.min)}, {"max", vector_of(world.bounds.max)}}},
          {"max_bodies", world.max_bodies},
          {"regions", std::move(regions)},
          {"definitions", std::move(definitions)},
          {"statics", json::array({{{"name", "ground"},
                                    {"shape", {{"type", "plane"}}},
                                    {"position", json::array({0, 0, 0})}}})},
          {"bodies", json::array()},
          {"injectors", std::move(injectors)},
          {"spawn_points", json::array({{{"position", json::array({3, 0.95, 3})}}})}};
}

}  // namespace aureole
