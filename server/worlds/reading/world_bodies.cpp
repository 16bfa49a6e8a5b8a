// Bodies and static geometry of a world file.
#include <set>

#include "server/worlds/reading/arrangement.h"
#include "server/worlds/reading/shape_measure.h"
#include "server/worlds/reading/world_parts.h"

namespace aureole {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t statics_max = 4096;
constexpr Colour unpainted{};

/// What all bodies of one entry have in common.
struct Entry {
  BodyMaterial material;
  std::vector<Colour> colours;
  bool colour_by_layer = false;
  Vector3d position{0, 0, 0};
  Quaternionf orientation{Quaternionf::Identity()};
  Quaternionf body_orientation{Quaternionf::Identity()};
  bool standing = false;
  BodyState state;  ///< Velocities and activation.
  std::optional<RegionId> host;
};

Vector3f read_velocity(const JsonNode& entry, std::string_view key, const NumberRange& range) {
  const auto found = entry.find(key);
  return found ? Vector3f(read_vector(*found, range).cast<float>()) : Vector3f(0, 0, 0);
}

void read_motion(const JsonNode& node, const WorldDefinition& world, BodyState& state) {
  state.linear_velocity = read_velocity(node, "velocity", speed_mps);
  state.angular_velocity = read_velocity(node, "spin", {-100, 100, "rad/s"});
  if (state.linear_velocity.norm() > world.tolerances.speed_mps) {
    node.at("velocity")
        .refuse(fmt::format(
            "found a speed of {:.4g} m/s, expected at most the speed tolerance of {:g} m/s",
            state.linear_velocity.norm(), world.tolerances.speed_mps));
  }
  const auto asleep = node.find("asleep");
  if (!asleep || !asleep->boolean()) return;
  if (!state.linear_velocity.isZero(0) || !state.angular_velocity.isZero(0)) {
    asleep->refuse("found a body that is asleep and moves, expected one or the other");
  }
  state.activation = Activation::asleep;
  state.deactivation_time_s = world.physics.sleep_after_s;
}

Entry read_entry(const JsonNode& node, WorldReading& reading) {
  Entry e;
  if (!node.object({"name", "body", "colour", "colour_by", "position", "standing", "orientation",
                    "body_orientation", "velocity", "spin", "asleep", "host", "grid", "line",
                    "ring", "wall", "pyramid"})) {
    return e;
  }
  e.material = reading.parts.read_body(node.at("body"));
  e.colours = e.material.colours;
  if (const auto colour = node.find("colour")) e.colours = reading.parts.read_colours(*colour);
  if (e.colours.empty()) e.colours.push_back(unpainted);
  if (const auto by = node.find("colour_by")) {
    const std::string text = by->text(name_bytes_max);
    e.colour_by_layer = text == "layer";
    if (text != "layer" && text != "body") by->expected("\"body\" or \"layer\"");
  }
  e.position = read_vector(node.at("position"), coordinate_m);
  if (const auto standing = node.find("standing")) e.standing = standing->boolean();
  if (const auto o = node.find("orientation")) e.orientation = read_orientation(*o);
  if (const auto o = node.find("body_orientation")) e.body_orientation = read_orientation(*o);
  read_motion(node, reading.world, e.state);
  if (const auto host = node.find("host")) {
    const auto found = reading.region_names.find(host->text(name_bytes_max));
    if (found == reading.region_names.end()) {
      host->expected("the name of a region");
    } else {
      e.host = found->second;
    }
  }
  return e;
}

bool inside(const Box3& box, const Vector3d& p) {
  return (p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all();
}

/// Adds the entry's bodies; false after a mistake.
bool place_entry(const JsonNode& node, const Entry& entry, WorldReading& reading) {
  WorldDefinition& world = reading.world;
  const Shape& shape = entry.material.body.shape;
  const Reach own = reach_of(shape, entry.body_orientation);
  const std::vector<Place> places = read_arrangement(node, own.size().cast<double>());
  if (!node.ok()) return false;
  if (world.bodies.size() + places.size() > world.max_bodies) {
    node.refuse(
        fmt::format("found {} bodies up to here, expected at most \"max_bodies\", which is {}",
                    world.bodies.size() + places.size(), world.max_bodies));
    return false;
  }
  std::vector<PrototypeId> painted;
  for (Colour c : entry.colours) painted.push_back(reading.prototypes.add(entry.material, c, node));
  // Standing: the lowest place's body touches the position's height.
  const double lift =
      entry.standing ? -double{reach_of(shape, entry.orientation * entry.body_orientation).min.y()}
                     : 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& place = places[i];
    const Quaternionf yaw(Eigen::AngleAxisf(static_cast<float>(place.yaw_rad), Vector3f::UnitY()));
    WorldBody body;
    body.prototype = painted[(entry.colour_by_layer ? place.layer : i) % painted.size()];
    body.state = entry.state;
    body.state.orientation = (entry.orientation * yaw * entry.body_orientation).normalized();
    Vector3d p =
        entry.position + entry.orientation.cast<double>() * place.position + Vector3d(0, lift, 0);
    // A standing body's reach is measured from its centre of mass already, but only upwards.
    Vector3f centre = body.state.orientation * entry.material.centre;
    if (entry.standing) centre.y() = 0;
    p += centre.cast<double>();
    if (!inside(world.bounds, p)) {
      node.refuse(fmt::format(
          "found body {} of {} at ({:g}, {:g}, {:g}) m, expected it inside the world's bounds",
          i + 1, places.size(), p.x(), p.y(), p.z()));
      return false;
    }
    body.state.position = WorldPosition::from(p);
    body.host = entry.host;
    world.bodies.push_back(body);
  }
  return node.ok();
}

}  // namespace

void read_bodies(const JsonNode& node, WorldReading& reading) {
  std::set<std::string> names;
  for (const JsonNode& item : node.items(0, world_bodies_max)) {
    const Entry entry = read_entry(item, reading);
    if (!node.ok()) return;
    const std::size_t first = reading.world.bodies.size();
    if (!place_entry(item, entry, reading)) return;
    if (const auto name_node = item.find("name")) {
      const std::string name = name_node->text(name_bytes_max);
      if (!names.insert(name).second)
        return name_node->expected("a name that no other entry of \"bodies\" has");
      reading.world.body_groups.push_back(
          {name, static_cast<std::uint32_t>(first),
           static_cast<std::uint32_t>(reading.world.bodies.size() - first)});
    }
  }
}

void read_statics(const JsonNode& node, WorldReading& reading) {
  std::set<std::string> names;
  for (const JsonNode& item : node.items(0, statics_max)) {
    if (!item.object(
            {"name", "shape", "position", "orientation", "friction", "restitution", "colour"}))
      return;
    WorldStatic out;
    const JsonNode name = item.at("name");
    out.name = name.text(name_bytes_max);
    if (node.ok() && !names.insert(out.name).second)
      name.expected("a name that no other static has");
    const CentredShape shape = read_shape(item.at("shape"), true);
    Vector3d p = read_vector(item.at("position"), coordinate_m);
    if (const auto o = item.find("orientation")) {
      out.body.orientation = read_orientation(*o);
      if (std::holds_alternative<PlaneShape>(shape.shape))
        o->refuse("found a plane that is turned, expected none: planes are horizontal");
    }
    p += (out.body.orientation * shape.centre).cast<double>();
    out.body.shape = shape.shape;
    out.body.position = WorldPosition::from(p);
    if (const auto f = item.find("friction"))
      out.body.friction = static_cast<float>(f->number({0, 10}));
    if (const auto r = item.find("restitution"))
      out.body.restitution = static_cast<float>(r->number({0, 1}));
    out.colour = {150, 150, 145};
    if (const auto c = item.find("colour")) out.colour = read_colour(*c);
    if (!node.ok()) return;
    reading.world.statics.push_back(std::move(out));
  }
}

}  // namespace aureole
