// Settings, regions, injectors, spawn points and what players are and throw.
#include <cmath>
#include <numbers>
#include <set>

#include "server/worlds/reading/world_parts.h"
#include "server/worlds/region_tiling.h"

namespace aureole {
namespace {

using Eigen::Vector3d;

constexpr std::size_t injectors_max = 1024;
constexpr std::size_t spawn_points_max = 1024;

bool inside(const Box3& outer, const Vector3d& p) {
  return (p.array() >= outer.min.array()).all() && (p.array() <= outer.max.array()).all();
}

/// The one colour of a thing that is made one at a time.
Colour first_colour(const JsonNode& node, const BodyMaterial& material) {
  if (const auto colour = node.find("colour")) return read_colour(*colour);
  return material.colours.empty() ? Colour{} : material.colours.front();
}

double optional_number(const JsonNode& node, std::string_view key, double fallback,
                       const NumberRange& range) {
  const auto found = node.find(key);
  return found ? found->number(range) : fallback;
}

void read_velocities(const JsonNode& node, const WorldDefinition& world, Injector& injector) {
  const Box3 range = read_box(node, speed_mps);
  injector.velocity_min = range.min.cast<float>();
  injector.velocity_max = range.max.cast<float>();
  const double fastest = range.min.cwiseAbs().cwiseMax(range.max.cwiseAbs()).norm();
  if (fastest > world.tolerances.speed_mps) {
    node.refuse(fmt::format(
        "found speeds up to {:.4g} m/s, expected at most the speed tolerance of {:g} m/s", fastest,
        world.tolerances.speed_mps));
  }
}

/// What fast things must stay below.
NumberRange throwing_speed(const WorldDefinition& world) {
  return {0, world.tolerances.speed_mps, "m/s (the speed tolerance)", true};
}

BodyMaterial simple(std::string name, Shape shape, float mass, float restitution, Colour colour) {
  BodyMaterial m;
  m.name = std::move(name);
  m.body.shape = std::move(shape);
  m.body.mass_kg = mass;
  m.body.restitution = restitution;
  m.colours = {colour};
  return m;
}

}  // namespace

Box3 read_box(const JsonNode& node, const NumberRange& range) {
  Box3 box;
  if (!node.object({"min", "max"})) return box;
  box.min = read_vector(node.at("min"), range);
  box.max = read_vector(node.at("max"), range);
  if (node.ok() && (box.min.array() > box.max.array()).any()) {
    node.refuse("found a min above its max, expected min ≤ max on each axis");
  }
  return box;
}

Rectangle read_area(const JsonNode& node) {
  Rectangle area;
  if (!node.object({"min_x", "max_x", "min_z", "max_z"})) return area;
  area.min_x = optional_number(node, "min_x", area.min_x, coordinate_m);
  area.max_x = optional_number(node, "max_x", area.max_x, coordinate_m);
  area.min_z = optional_number(node, "min_z", area.min_z, coordinate_m);
  area.max_z = optional_number(node, "max_z", area.max_z, coordinate_m);
  if (node.ok() && (area.min_x >= area.max_x || area.min_z >= area.max_z)) {
    node.refuse("found a min that is not below its max, expected an area that is not empty");
  }
  return area;
}

void read_physics(const JsonNode& node, PhysicsSettings& settings) {
  if (!node.object({"gravity", "solver_iterations", "sleep_linear_speed", "sleep_angular_speed",
                    "sleep_after_s"}))
    return;
  const auto optional = [&](std::string_view key, float& value, const NumberRange& range) {
    if (const auto found = node.find(key)) value = static_cast<float>(found->number(range));
  };
  if (const auto g = node.find("gravity"))
    settings.gravity = read_vector(*g, {-100, 100, "m/s²"}).cast<float>();
  if (const auto n = node.find("solver_iterations"))
    settings.solver_iterations = static_cast<int>(n->integer(1, 50));
  optional("sleep_linear_speed", settings.sleep_linear_speed, {0, 10, "m/s"});
  optional("sleep_angular_speed", settings.sleep_angular_speed, {0, 10, "rad/s"});
  optional("sleep_after_s", settings.sleep_after_s, {0.016, 60, "s"});
}

void read_tolerances(const JsonNode& node, AuraTolerances& tolerances) {
  if (!node.object({"speed_mps", "latency_ms", "frame_time_ms"})) return;
  tolerances.speed_mps =
      optional_number(node, "speed_mps", tolerances.speed_mps, {0.1, 1000, "m/s"});
  tolerances.latency_ms =
      optional_number(node, "latency_ms", tolerances.latency_ms, {0, 10'000, "ms"});
  tolerances.frame_time_ms =
      optional_number(node, "frame_time_ms", tolerances.frame_time_ms, {0.1, 1000, "ms"});
}

MigrationMode read_mode(const JsonNode& node) {
  const auto mode = node.is_string() ? migration_mode_from(node.text(name_bytes_max))
                                     : std::optional<MigrationMode>{};
  if (!mode) node.expected("\"naive\", \"paper\" or \"adaptive\"");
  return mode.value_or(MigrationMode::adaptive);
}

void read_regions(const JsonNode& node, WorldReading& reading) {
  for (const JsonNode& item : node.items(1, regions_max)) {
    if (!item.object({"name", "area"})) return;
    const JsonNode name_node = item.at("name");
    const std::string name = name_node.text(name_bytes_max);
    const RegionId id{static_cast<std::uint16_t>(reading.world.regions.size())};
    if (node.ok() && !reading.region_names.emplace(name, id).second)
      name_node.expected("a name that no other region has");
    reading.world.regions.push_back({name, read_area(item.at("area"))});
    if (!node.ok()) return;
  }
  if (const auto mistake = node.ok() ? tiling_mistake(reading.world.regions) : std::nullopt)
    node.refuse(*mistake);
}

void read_injectors(const JsonNode& node, WorldReading& reading) {
  std::set<std::string> names;
  for (const JsonNode& item : node.items(0, injectors_max)) {
    if (!item.object(
            {"name", "rate_per_s", "volume", "velocity", "mix", "seed", "start_s", "duration_s"}))
      return;
    Injector out;
    const JsonNode name = item.at("name");
    out.name = name.text(name_bytes_max);
    if (node.ok() && !names.insert(out.name).second)
      name.expected("a name that no other injector has");
    out.rate_per_s = item.at("rate_per_s").number({0, 100'000, "bodies/s", true});
    const JsonNode volume = item.at("volume");
    out.volume = read_box(volume, coordinate_m);
    if (node.ok() && !(inside(reading.world.bounds, out.volume.min) &&
                       inside(reading.world.bounds, out.volume.max))) {
      volume.refuse("found a volume that reaches outside the world's bounds, expected one inside");
    }
    if (const auto v = item.find("velocity")) read_velocities(*v, reading.world, out);
    for (const JsonNode& share : item.at("mix").items(1, 64)) {
      if (!share.object({"body", "weight", "colour"})) return;
      const BodyMaterial material = reading.parts.read_body(share.at("body"));
      if (!node.ok()) return;
      // A palette gives one prototype a colour; together they keep the share's weight.
      std::vector<Colour> colours = material.colours;
      if (const auto c = share.find("colour")) colours = reading.parts.read_colours(*c);
      if (colours.empty()) colours.push_back({});
      const double weight = optional_number(share, "weight", 1, {0, 1e6, "", true});
      for (Colour c : colours) {
        out.mix.push_back({reading.prototypes.add(material, c, share),
                           weight / static_cast<double>(colours.size())});
      }
    }
    if (const auto s = item.find("seed"))
      out.seed = static_cast<std::uint64_t>(s->integer(0, 9'007'199'254'740'991));
    out.start_s = optional_number(item, "start_s", 0, {-1e9, 1e9, "s"});
    out.duration_s = optional_number(item, "duration_s", out.duration_s, {0, 1e9, "s", true});
    if (!node.ok()) return;
    reading.world.injectors.push_back(std::move(out));
  }
}

void read_spawn_points(const JsonNode& node, WorldReading& reading) {
  for (const JsonNode& item : node.items(1, spawn_points_max)) {
    if (!item.object({"position", "yaw_deg"})) return;
    const JsonNode position = item.at("position");
    const Vector3d p = read_vector(position, coordinate_m);
    const double yaw = optional_number(item, "yaw_deg", 0, angle_deg) * std::numbers::pi / 180;
    if (node.ok() && !inside(reading.world.bounds, p))
      position.refuse("found a spawn point outside the world's bounds, expected one inside");
    if (!node.ok()) return;
    reading.world.spawn_points.push_back({WorldPosition::from(p), static_cast<float>(yaw)});
  }
}

void read_throwables(const JsonNode* node, WorldReading& reading, const JsonNode& root) {
  auto& slots = reading.world.throwables;
  if (!node) {
    const std::array<BodyMaterial, 4> usual = {
        simple("rubber ball", SphereShape{0.22f}, 2, 0.75f, {232, 93, 79}),
        simple("heavy ball", SphereShape{0.35f}, 30, 0.1f, {62, 68, 84}),
        simple("crate", BoxShape{{0.3f, 0.3f, 0.3f}}, 8, 0.05f, {201, 152, 96}),
        simple("plank", BoxShape{{1.0f, 0.06f, 0.2f}}, 8, 0.05f, {170, 121, 78})};
    const std::array<double, 4> speeds = {24, 20, 14, 12};
    for (std::size_t i = 0; i < slots.size(); ++i) {
      const double speed = std::min(speeds[i], reading.world.tolerances.speed_mps);
      slots[i] = {usual[i].name, reading.prototypes.add(usual[i], usual[i].colours[0], root),
                  static_cast<float>(speed)};
    }
    return;
  }
  std::set<std::string> names;
  std::size_t i = 0;
  for (const JsonNode& item : node->items(slots.size(), slots.size())) {
    if (!item.object({"name", "body", "colour", "speed_mps"})) return;
    const JsonNode name = item.at("name");
    Throwable& out = slots[i++];
    out.name = name.text(name_bytes_max);
    if (node->ok() && !names.insert(out.name).second)
      name.expected("a name that no other throwable has");
    const BodyMaterial material = reading.parts.read_body(item.at("body"));
    if (!node->ok()) return;
    out.prototype = reading.prototypes.add(material, first_colour(item, material), item);
    out.speed_mps = static_cast<float>(item.at("speed_mps").number(throwing_speed(reading.world)));
  }
}

void read_avatar(const JsonNode* node, WorldReading& reading, const JsonNode& root) {
  CapsuleShape capsule{0.35f, 1.8f};
  BodyMaterial material = simple("avatar", capsule, 80, 0, {240, 180, 70});
  if (node) {
    if (!node->object({"radius", "height", "mass_kg", "colour"})) return;
    capsule.radius =
        static_cast<float>(optional_number(*node, "radius", double{capsule.radius}, {0.1, 2, "m"}));
    NumberRange height{2 * double{capsule.radius}, 5, "m"};
    if (const auto h = node->find("height")) capsule.height = static_cast<float>(h->number(height));
    capsule.height = std::max(capsule.height, 2 * capsule.radius);
    material.body.mass_kg =
        static_cast<float>(optional_number(*node, "mass_kg", 80, {1, 10'000, "kg"}));
    if (const auto c = node->find("colour")) material.colours = {read_colour(*c)};
  }
  // Upright, and sliding past what it touches: the player's walking is the only friction it knows.
  material.body.shape = capsule;
  material.body.upright = true;
  material.body.friction = 0;
  reading.world.avatar = reading.prototypes.add(material, material.colours[0], root);
}

}  // namespace aureole
