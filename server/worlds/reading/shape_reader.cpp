// Shapes, poses and colours from JSON.
#include <cmath>
#include <numbers>

#include "server/worlds/reading/body_reader.h"
#include "server/worlds/reading/shape_measure.h"

namespace aureole {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

const std::vector<std::string> shape_types = {"sphere",      "box",      "capsule", "cylinder",
                                              "convex_hull", "compound", "plane"};

Shape read_hull(const JsonNode& node) {
  ConvexHullShape hull;
  const JsonNode points = node.at("points");
  for (const JsonNode& point : points.items(4, hull_points_max)) {
    hull.points.push_back(read_vector(point, {-1000, 1000, "m"}).cast<float>());
  }
  if (node.ok() && !convex_hull_volume(hull.points)) {
    points.expected("points that do not all lie in one plane");
  }
  return hull;
}

Shape read_compound(const JsonNode& node) {
  CompoundShape compound;
  for (const JsonNode& child : node.at("children").items(1, compound_children_max)) {
    if (!child.object({"shape", "position", "orientation"})) break;
    const JsonNode shape = child.at("shape");
    const auto type = shape.find("type");
    if (type && type->is_string() && type->text(name_bytes_max) == "compound") {
      type->expected("a shape that is not a compound itself");
      break;
    }
    CentredShape part = read_shape(shape);
    CompoundShape::Child c;
    if (auto p = child.find("position"))
      c.position = read_vector(*p, {-1000, 1000, "m"}).cast<float>();
    if (auto o = child.find("orientation")) c.orientation = read_orientation(*o);
    c.position += c.orientation * part.centre;
    c.shape = std::make_shared<const Shape>(std::move(part.shape));
    compound.children.push_back(std::move(c));
  }
  return compound;
}

/// Moves points or children so that the centre of mass is the origin, as physics wants it.
CentredShape about_centre_of_mass(Shape shape) {
  const Vector3f centre = volume_and_centre(shape).centre.cast<float>();
  if (auto* hull = std::get_if<ConvexHullShape>(&shape)) {
    for (Vector3f& p : hull->points) p -= centre;
  }
  if (auto* compound = std::get_if<CompoundShape>(&shape)) {
    for (auto& child : compound->children) child.position -= centre;
  }
  return {std::move(shape), centre};
}

/// Capsules and cylinders; a capsule's height has room for its caps.
Shape read_round(const JsonNode& node, bool capsule) {
  if (!node.object({"type", "radius", "height"})) return SphereShape{0.5f};
  const auto radius = static_cast<float>(node.at("radius").number(length_m));
  NumberRange height = length_m;
  if (capsule) height.min = 2 * double{radius} - 1e-6;
  const auto h = static_cast<float>(node.at("height").number(height));
  if (capsule) return CapsuleShape{radius, std::max(h, 2 * radius)};
  return CylinderShape{radius, h};
}

}  // namespace

Eigen::Vector3d read_vector(const JsonNode& node, const NumberRange& range) {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Index i = 0;
  for (const JsonNode& item : node.items(3, 3)) v[i++] = item.number(range);
  return v;
}

Quaternionf read_orientation(const JsonNode& node) {
  if (!node.object({"yaw_deg", "pitch_deg", "roll_deg", "quaternion"}))
    return Quaternionf::Identity();
  if (const auto given = node.find("quaternion")) {
    if (node.has("yaw_deg") || node.has("pitch_deg") || node.has("roll_deg")) {
      node.expected("either angles or a quaternion");
      return Quaternionf::Identity();
    }
    std::array<double, 4> q{0, 0, 0, 1};
    std::size_t i = 0;
    for (const JsonNode& item : given->items(4, 4)) q[i++] = item.number({-1, 1});
    const Eigen::Quaterniond out(q[3], q[0], q[1], q[2]);
    if (node.ok() && std::abs(out.norm() - 1) > 1e-3) {
      given->refuse(
          fmt::format("found a quaternion of length {:.4g}, expected 1 within 0.001", out.norm()));
      return Quaternionf::Identity();
    }
    return out.normalized().cast<float>();
  }
  const auto angle = [&](std::string_view key) {
    const auto found = node.find(key);
    return found ? found->number(angle_deg) * std::numbers::pi / 180 : 0.0;
  };
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Eigen::Quaterniond q = AngleAxisd(angle("yaw_deg"), Vector3d::UnitY()) *
                               AngleAxisd(angle("pitch_deg"), Vector3d::UnitX()) *
                               AngleAxisd(angle("roll_deg"), Vector3d::UnitZ());
  return q.normalized().cast<float>();
}

Colour read_colour(const JsonNode& node) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  const std::string text = node.is_string() ? node.text(name_bytes_max) : "";
  std::array<std::uint8_t, 3> rgb{};
  bool good = text.size() == 7 && text[0] == '#';
  for (std::size_t i = 0; good && i < 3; ++i) {
    const int high = digit(text[1 + 2 * i]), low = digit(text[2 + 2 * i]);
    good = high >= 0 && low >= 0;
    if (good) rgb[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  if (!good) node.expected("a colour like \"#c0ffee\"");
  return {rgb[0], rgb[1], rgb[2]};
}

CentredShape read_shape(const JsonNode& node, bool plane_allowed) {
  const CentredShape fallback;
  const JsonNode type_node = node.at("type");
  if (!node.ok()) return fallback;
  const std::string type = type_node.text(name_bytes_max);
  Shape shape = fallback.shape;
  if (type == "sphere") {
    if (!node.object({"type", "radius"})) return fallback;
    shape = SphereShape{static_cast<float>(node.at("radius").number(length_m))};
  } else if (type == "box") {
    if (!node.object({"type", "size"})) return fallback;
    shape = BoxShape{(read_vector(node.at("size"), length_m) / 2).cast<float>()};
  } else if (type == "capsule" || type == "cylinder") {
    shape = read_round(node, type == "capsule");
  } else if (type == "convex_hull") {
    if (!node.object({"type", "points"})) return fallback;
    shape = read_hull(node);
  } else if (type == "compound") {
    if (!node.object({"type", "children"})) return fallback;
    shape = read_compound(node);
  } else if (type == "plane") {
    if (!node.object({"type"})) return fallback;
    if (plane_allowed) return {PlaneShape{}, {0, 0, 0}};
    type_node.expected("a shape with a volume (planes are for \"statics\")");
  } else if (node.ok()) {
    const auto meant = likely_meant(type, shape_types);
    type_node.expected("sphere, box, capsule, cylinder, convex_hull, compound or (statics) plane" +
                       (meant ? fmt::format(": did you mean \"{}\"?", *meant) : std::string()));
  }
  return node.ok() ? about_centre_of_mass(std::move(shape)) : fallback;
}

}  // namespace aureole
