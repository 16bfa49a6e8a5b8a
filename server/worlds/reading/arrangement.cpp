// Reads each construct's few numbers and computes its places.
#include "server/worlds/reading/arrangement.h"

#include <cmath>
#include <numbers>

#include "server/worlds/reading/body_reader.h"

namespace aureole {
namespace {

using Eigen::Vector3d;

constexpr double radians = std::numbers::pi / 180;
constexpr NumberRange step_m{0, 1000, "m"};
constexpr NumberRange offset_m{-10'000, 10'000, "m"};

double optional_number(const JsonNode& node, std::string_view key, double fallback,
                       const NumberRange& range) {
  const auto found = node.find(key);
  return found ? found->number(range) : fallback;
}

std::int64_t optional_integer(const JsonNode& node, std::string_view key, std::int64_t fallback,
                              std::int64_t min, std::int64_t max) {
  const auto found = node.find(key);
  return found ? found->integer(min, max) : fallback;
}

/// True if a construct of this many bodies is allowed.
bool fits(const JsonNode& node, double count) {
  if (count <= static_cast<double>(world_bodies_max)) return true;
  node.refuse(fmt::format("found a construct of {:.0f} bodies, expected at most {}", count,
                          world_bodies_max));
  return false;
}

/// A gap is sideways only: layers stand on each other.
Vector3d steps_of(const JsonNode& node, const Vector3d& size) {
  const double gap = optional_number(node, "gap", 0, {0, 100, "m"});
  const auto step = node.find("step");
  if (step && node.has("gap")) step->refuse("found both a step and a gap, expected one of them");
  NumberRange range = step_m;
  range.above_min = true;
  return step ? read_vector(*step, range) : Vector3d(size + Vector3d(gap, 0, gap));
}

std::vector<Place> grid(const JsonNode& node, const Vector3d& size) {
  if (!node.object({"count", "step", "gap", "stagger", "turn_deg_per_layer"})) return {};
  std::array<std::int64_t, 3> n{0, 0, 0};
  std::size_t axis = 0;
  for (const JsonNode& item : node.at("count").items(3, 3)) n[axis++] = item.integer(1, 10'000);
  const Vector3d step = steps_of(node, size);
  const double stagger = optional_number(node, "stagger", 0, {0, 1});
  const double turn =
      optional_number(node, "turn_deg_per_layer", 0, {-180, 180, "degrees"}) * radians;
  if (!node.ok() || !fits(node, static_cast<double>(n[0]) * static_cast<double>(n[1]) *
                                    static_cast<double>(n[2])))
    return {};
  std::vector<Place> out;
  for (std::int64_t y = 0; y < n[1]; ++y) {
    const double yaw = turn * static_cast<double>(y);
    const Eigen::AngleAxisd turned(yaw, Vector3d::UnitY());
    const double shift = y % 2 == 1 ? stagger : 0;
    for (std::int64_t z = 0; z < n[2]; ++z) {
      for (std::int64_t x = 0; x < n[0]; ++x) {
        const Vector3d flat(
            (static_cast<double>(x) - static_cast<double>(n[0] - 1) / 2 + shift) * step.x(), 0,
            (static_cast<double>(z) - static_cast<double>(n[2] - 1) / 2 + shift) * step.z());
        const Vector3d p = turned * flat + Vector3d(0, static_cast<double>(y) * step.y(), 0);
        out.push_back({p, yaw, static_cast<std::size_t>(y)});
      }
    }
  }
  return out;
}

std::vector<Place> line(const JsonNode& node) {
  if (!node.object({"points", "spacing", "smooth", "closed"})) return {};
  std::vector<Vector3d> points;
  for (const JsonNode& item : node.at("points").items(1, 4096))
    points.push_back(read_vector(item, offset_m));
  const auto flag = [&](std::string_view key) {
    const auto found = node.find(key);
    return found && found->boolean();
  };
  PathOptions options;
  options.smooth = flag("smooth");
  options.closed = flag("closed");
  if (!node.ok()) return {};
  if (!node.has("spacing")) {
    if (options.smooth || options.closed)
      node.refuse("found no key \"spacing\", expected one with a smooth or closed line");
    std::vector<Place> out;
    for (const Vector3d& p : points) out.push_back({p, 0, 0});
    return out;
  }
  options.spacing_m = node.at("spacing").number({0.01, 1000, "m"});
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  if (points.size() < 2 || length < 1e-3) {
    node.at("points").expected("two points or more that are apart, for a spacing");
    return {};
  }
  if (!node.ok() || !fits(node, length / options.spacing_m)) return {};
  return places_along(points, options);
}

std::vector<Place> ring(const JsonNode& node, const Vector3d& size) {
  if (!node.object({"radius", "count", "from_deg", "to_deg", "layers", "layer_step", "stagger"}))
    return {};
  const double radius = node.at("radius").number({0.01, 10'000, "m"});
  const std::int64_t count = node.at("count").integer(1, 10'000);
  const double from = optional_number(node, "from_deg", 0, {-360, 360, "degrees"}) * radians;
  const bool whole = !node.has("to_deg");
  const double to = optional_number(node, "to_deg", 0, {-360, 720, "degrees"}) * radians;
  const std::int64_t layers = optional_integer(node, "layers", 1, 1, 1000);
  const double rise = optional_number(node, "layer_step", size.y(), {0.001, 1000, "m"});
  const double stagger = optional_number(node, "stagger", 0, {0, 1});
  if (!node.ok() || !fits(node, static_cast<double>(count) * static_cast<double>(layers)))
    return {};
  // A whole circle's last body stands one step before its first.
  const double step = whole       ? 2 * std::numbers::pi / static_cast<double>(count)
                      : count > 1 ? (to - from) / static_cast<double>(count - 1)
                                  : 0;
  std::vector<Place> out;
  for (std::int64_t y = 0; y < layers; ++y) {
    for (std::int64_t i = 0; i < count; ++i) {
      const double a = from + step * (static_cast<double>(i) + (y % 2 == 1 ? stagger : 0));
      out.push_back({{radius * std::cos(a), static_cast<double>(y) * rise, -radius * std::sin(a)},
                     a + std::numbers::pi / 2,
                     static_cast<std::size_t>(y)});
    }
  }
  return out;
}

std::vector<Place> wall(const JsonNode& node, const Vector3d& size) {
  if (!node.object({"length", "rows", "gap"})) return {};
  const std::int64_t length = node.at("length").integer(1, 10'000);
  const std::int64_t rows = node.at("rows").integer(1, 1000);
  const double gap = optional_number(node, "gap", 0, {0, 100, "m"});
  if (!node.ok() || !fits(node, static_cast<double>(length) * static_cast<double>(rows))) return {};
  std::vector<Place> out;
  for (std::int64_t y = 0; y < rows; ++y) {
    // Every second row is a quarter brick further: joints are bridged, and each end brick still has
    // its centre over the one below (half a brick further it would balance on an edge).
    const double shift = y % 2 == 1 ? 0.125 : -0.125;
    for (std::int64_t i = 0; i < length; ++i) {
      const double x =
          (static_cast<double>(i) - static_cast<double>(length - 1) / 2 + shift) * (size.x() + gap);
      out.push_back({{x, static_cast<double>(y) * size.y(), 0}, 0, static_cast<std::size_t>(y)});
    }
  }
  return out;
}

std::vector<Place> pyramid(const JsonNode& node, const Vector3d& size) {
  if (!node.object({"base", "layers", "step", "gap"})) return {};
  std::array<std::int64_t, 2> base{0, 0};
  std::size_t axis = 0;
  for (const JsonNode& item : node.at("base").items(2, 2)) base[axis++] = item.integer(1, 100);
  const std::int64_t all = std::max(base[0], base[1]);
  const std::int64_t layers = optional_integer(node, "layers", all, 1, all);
  const Vector3d step = steps_of(node, size);
  if (!node.ok() ||
      !fits(node, static_cast<double>(base[0] * base[1]) * static_cast<double>(layers)))
    return {};
  std::vector<Place> out;
  for (std::int64_t y = 0; y < layers; ++y) {
    // A side shrinks by one a layer; one that has come down to 1 stays there.
    const std::int64_t nx = std::max<std::int64_t>(1, base[0] - y),
                       nz = std::max<std::int64_t>(1, base[1] - y);
    for (std::int64_t z = 0; z < nz; ++z) {
      for (std::int64_t x = 0; x < nx; ++x) {
        out.push_back({{(static_cast<double>(x) - static_cast<double>(nx - 1) / 2) * step.x(),
                        static_cast<double>(y) * step.y(),
                        (static_cast<double>(z) - static_cast<double>(nz - 1) / 2) * step.z()},
                       0,
                       static_cast<std::size_t>(y)});
      }
    }
  }
  return out;
}

}  // namespace

std::vector<Place> read_arrangement(const JsonNode& entry, const Vector3d& size) {
  std::optional<JsonNode> construct;
  std::string kind;
  for (const char* key : {"grid", "line", "ring", "wall", "pyramid"}) {
    const auto found = entry.find(key);
    if (!found) continue;
    if (construct) {
      found->refuse(
          fmt::format("found a second construct beside \"{}\", expected one at most", kind));
      return {};
    }
    construct = found;
    kind = key;
  }
  if (!construct) return {Place{}};
  if (kind == "grid") return grid(*construct, size);
  if (kind == "line") return line(*construct);
  if (kind == "ring") return ring(*construct, size);
  if (kind == "wall") return wall(*construct, size);
  return pyramid(*construct, size);
}

}  // namespace aureole
