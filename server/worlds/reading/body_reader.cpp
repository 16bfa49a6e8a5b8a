// Body definitions, palettes, and the table that merges equal bodies to one prototype.
#include "server/worlds/reading/body_reader.h"

#include <bit>

#include "server/worlds/reading/shape_measure.h"

namespace aureole {
namespace {

const std::initializer_list<std::string_view> definition_keys = {
    "shape",       "mass_kg",        "density_kg_m3",   "friction",
    "restitution", "linear_damping", "angular_damping", "colour"};

/// Lighter bodies have no mass left in single precision, or are flung away by every touch.
constexpr double lightest_kg = 1e-6;

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> out;
  for (const auto& [name, value] : map) out.push_back(name);
  return out;
}

float read_mass(const JsonNode& node, const Shape& shape) {
  const auto mass = node.find("mass_kg");
  const auto density = node.find("density_kg_m3");
  if (mass.has_value() == density.has_value()) {
    node.refuse(fmt::format("found {}, expected either \"mass_kg\" or \"density_kg_m3\"",
                            mass ? "both masses" : "no mass"));
    return 1;
  }
  if (mass) {
    const double kg = mass->number(mass_kg);
    if (kg < lightest_kg)
      mass->refuse(fmt::format("found {:g} kg, expected at least {:g} kg", kg, lightest_kg));
    return static_cast<float>(kg);
  }
  const double kg =
      density->number({0, 30'000, "kg/m³", true}) * volume_and_centre(shape).volume_m3;
  if (kg > mass_kg.max) {
    density->refuse(fmt::format("found a density that makes {:g} kg, expected at most {:g} kg", kg,
                                mass_kg.max));
    return 1;
  }
  if (kg < lightest_kg)
    density->refuse(fmt::format("found a density that makes {:g} kg, expected at least {:g} kg", kg,
                                lightest_kg));
  return static_cast<float>(kg);
}

std::string shape_name(const Shape& shape) {
  constexpr std::array<const char*, 7> names = {"sphere",      "box",      "capsule", "cylinder",
                                                "convex hull", "compound", "plane"};
  return names[shape.index()];
}

/// Appends numbers bit by bit; adding 0 turns -0 into 0.
struct Bytes {
  std::string out;
  void add(float v) {
    const auto bits = std::bit_cast<std::array<char, 4>>(v + 0.0f);
    out.append(bits.data(), bits.size());
  }
  void add(const Eigen::Vector3f& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(std::size_t n) { add(static_cast<float>(n)); }

  void operator()(const SphereShape& s) { add(s.radius); }
  void operator()(const BoxShape& s) { add(s.half_extents); }
  void operator()(const CapsuleShape& s) { add(s.radius), add(s.height); }
  void operator()(const CylinderShape& s) { add(s.radius), add(s.height); }
  void operator()(const ConvexHullShape& s) {
    add(s.points.size());
    for (const auto& p : s.points) add(p);
  }
  void operator()(const CompoundShape& s) {
    add(s.children.size());
    for (const auto& child : s.children) {
      out += canonical_bytes(*child.shape);
      add(child.position);
      for (int i = 0; i < 4; ++i) add(child.orientation.coeffs()[i]);
    }
  }
  void operator()(const PlaneShape&) {}
};

}  // namespace

std::string canonical_bytes(const Shape& shape) {
  Bytes bytes;
  bytes.out.push_back(static_cast<char>(shape.index()));
  std::visit(bytes, static_cast<const Shape::variant&>(shape));
  return bytes.out;
}

std::string canonical_bytes(const BodyDefinition& b) {
  Bytes bytes{canonical_bytes(b.shape)};
  for (float v : {b.mass_kg, b.friction, b.restitution, b.linear_damping, b.angular_damping})
    bytes.add(v);
  bytes.out.push_back(b.upright ? 1 : 0);
  return bytes.out;
}

NamedParts::NamedParts(const JsonNode& root) {
  if (const auto palettes = root.find("palettes")) {
    for (const auto& [name, node] : palettes->members()) {
      std::vector<Colour> colours;
      for (const JsonNode& item : node.items(1, 64)) colours.push_back(read_colour(item));
      palettes_.emplace(name, std::move(colours));
    }
  }
  if (const auto definitions = root.find("definitions")) {
    for (const auto& [name, node] : definitions->members()) {
      BodyMaterial material = read_definition(node);
      if (name.empty() || name.size() > name_bytes_max) {
        node.refuse(
            fmt::format("found a name of {} bytes, expected 1 to {}", name.size(), name_bytes_max));
      }
      material.name = name;
      definitions_.emplace(name, std::move(material));
    }
  }
}

BodyMaterial NamedParts::read_body(const JsonNode& node) const {
  if (!node.is_string()) {
    if (!node.is_object()) node.expected("the name of a definition, or a definition");
    return node.ok() ? read_definition(node) : BodyMaterial{};
  }
  const std::string name = node.text(name_bytes_max);
  if (const auto found = definitions_.find(name); found != definitions_.end()) return found->second;
  const auto meant = likely_meant(name, names_of(definitions_));
  node.expected(meant ? fmt::format("a name from \"definitions\": did you mean \"{}\"?", *meant)
                      : "a name from \"definitions\"");
  return {};
}

BodyMaterial NamedParts::read_definition(const JsonNode& node) const {
  BodyMaterial out;
  if (!node.object(definition_keys)) return out;
  CentredShape shape = read_shape(node.at("shape"));
  if (!node.ok()) return out;
  const auto optional = [&](std::string_view key, float fallback, double max) {
    const auto found = node.find(key);
    return found ? static_cast<float>(found->number({0, max})) : fallback;
  };
  BodyDefinition& body = out.body;
  out.name = shape_name(shape.shape);
  body.mass_kg = read_mass(node, shape.shape);
  body.friction = optional("friction", body.friction, 10);
  body.restitution = optional("restitution", body.restitution, 1);
  body.linear_damping = optional("linear_damping", body.linear_damping, 1);
  body.angular_damping = optional("angular_damping", body.angular_damping, 1);
  body.shape = std::move(shape.shape);
  out.centre = shape.centre;
  if (const auto colour = node.find("colour")) out.colours = read_colours(*colour);
  return out;
}

std::vector<Colour> NamedParts::read_colours(const JsonNode& node) const {
  if (node.is_array()) {
    std::vector<Colour> out;
    for (const JsonNode& item : node.items(1, 64)) out.push_back(read_colour(item));
    return out;
  }
  if (!node.is_string()) {
    node.expected("a colour like \"#c0ffee\", an array of them, or a name from \"palettes\"");
    return {};
  }
  const std::string text = node.text(name_bytes_max);
  if (text.starts_with('#')) return {read_colour(node)};
  if (const auto found = palettes_.find(text); found != palettes_.end()) return found->second;
  const auto meant = likely_meant(text, names_of(palettes_));
  node.expected("a colour like \"#c0ffee\" or a name from \"palettes\"" +
                (meant ? fmt::format(": did you mean \"{}\"?", *meant) : std::string()));
  return {};
}

PrototypeId PrototypeTable::add(const BodyMaterial& material, Colour colour, const JsonNode& node) {
  std::string key = canonical_bytes(material.body);
  for (std::uint8_t part : {colour.r, colour.g, colour.b}) key.push_back(static_cast<char>(part));
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  if (prototypes_.size() >= size_max) {
    node.refuse(fmt::format(
        "found more than {} different bodies (shape, mass, material and colour), expected fewer",
        size_max));
    return PrototypeId{0};
  }
  const PrototypeId id{static_cast<std::uint16_t>(prototypes_.size())};
  prototypes_.push_back({material.name, material.body, colour});
  known_.emplace(std::move(key), id);
  return id;
}

}  // namespace aureole
