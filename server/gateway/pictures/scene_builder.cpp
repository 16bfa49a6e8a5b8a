// Shapes become meshes once; poses become instances every time.
#include "server/gateway/pictures/scene_builder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/base/check.h"
#include "server/gateway/players/picking.h"

namespace aureole {
namespace {

struct HueSaturationValue {
  double hue, saturation, value;
};

/// Source: Alvy Ray Smith, "Color gamut transform pairs", 1978, written with its piecewise form.
Colour to_colour(const HueSaturationValue& c) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + c.hue * 6, 6.0);
    const double share = std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(255 * c.value * (1 - c.saturation * share)));
  };
  return {channel(5), channel(3), channel(1)};
}

render::Rgb to_rgb(Colour c) {
  return {c.r, c.g, c.b};
}

/// A third of the body's own colour stays, so that shapes remain told apart.
render::Rgb tinted_by(Colour own, Colour region) {
  const auto mix = [](int a, int b) { return static_cast<std::uint8_t>((a + 2 * b) / 3); };
  return {mix(own.r, region.r), mix(own.g, region.g), mix(own.b, region.b)};
}

struct ToSimpleShape {
  render::SimpleShape operator()(const SphereShape& s) const {
    return render::SphereShape{s.radius};
  }
  render::SimpleShape operator()(const BoxShape& s) const {
    return render::BoxShape{s.half_extents};
  }
  render::SimpleShape operator()(const CapsuleShape& s) const {
    return render::CapsuleShape{s.radius, s.height};
  }
  render::SimpleShape operator()(const CylinderShape& s) const {
    return render::CylinderShape{s.radius, s.height};
  }
  render::SimpleShape operator()(const ConvexHullShape& s) const {
    return render::HullShape{s.points};
  }
  render::SimpleShape operator()(const CompoundShape&) const { return impossible(); }
  render::SimpleShape operator()(const PlaneShape&) const { return impossible(); }
  static render::SimpleShape impossible() {
    AUREOLE_CHECK(false, "compounds hold neither compounds nor planes");
    return render::SphereShape{1};
  }
};

render::MeshShape to_mesh_shape(const Shape& shape) {
  const auto& variant = static_cast<const Shape::variant&>(shape);
  if (const auto* compound = std::get_if<CompoundShape>(&variant)) {
    render::CompoundShape out;
    for (const auto& child : compound->children)
      out.parts.push_back(
          {std::visit(ToSimpleShape{}, static_cast<const Shape::variant&>(*child.shape)),
           child.position, child.orientation});
    return out;
  }
  return std::visit([](auto simple) -> render::MeshShape { return simple; },
                    std::visit(ToSimpleShape{}, variant));
}

/// Every number of a shape in order, with its kind before them: equal lists are equal shapes.
void append_numbers(const Shape& shape, std::vector<float>& out) {
  const auto& variant = static_cast<const Shape::variant&>(shape);
  out.push_back(static_cast<float>(variant.index()));
  const auto vector = [&](const Eigen::Vector3f& v) {
    out.insert(out.end(), {v.x(), v.y(), v.z()});
  };
  if (const auto* s = std::get_if<SphereShape>(&variant)) {
    out.push_back(s->radius);
  } else if (const auto* b = std::get_if<BoxShape>(&variant)) {
    vector(b->half_extents);
  } else if (const auto* c = std::get_if<CapsuleShape>(&variant)) {
    out.insert(out.end(), {c->radius, c->height});
  } else if (const auto* y = std::get_if<CylinderShape>(&variant)) {
    out.insert(out.end(), {y->radius, y->height});
  } else if (const auto* h = std::get_if<ConvexHullShape>(&variant)) {
    for (const auto& point : h->points) vector(point);
  } else if (const auto* m = std::get_if<CompoundShape>(&variant)) {
    for (const auto& child : m->children) {
      vector(child.position);
      const Eigen::Quaternionf& q = child.orientation;
      out.insert(out.end(), {q.x(), q.y(), q.z(), q.w()});
      append_numbers(*child.shape, out);
    }
  }
}

Eigen::Vector4f to_vector(const Eigen::Quaternionf& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

Colour region_colour(RegionId region) {
  // The golden ratio keeps neighbours in number far apart in hue.
  const double hue = std::fmod(0.58 + region.value * 0.618'033'988'75, 1.0);
  return to_colour({hue, 0.62, 0.95});
}

Colour player_colour(PlayerId player) {
  const double hue = (player.value * 0x9e37'79b9u >> 8) / static_cast<double>(1u << 24);
  return to_colour({hue, 0.8, 0.95});
}

std::vector<render::BoundaryLine> boundary_lines(const PartitionMap& map, const Box3& bounds) {
  std::vector<render::BoundaryLine> lines;
  const auto point = [](double x, double z) {
    return Eigen::Vector2f(static_cast<float>(x), static_cast<float>(z));
  };
  for (const BoundarySegment& edge : map.boundaries()) {
    const double from_x = std::max(edge.from_x, bounds.min.x());
    const double from_z = std::max(edge.from_z, bounds.min.z());
    const double to_x = std::min(edge.to_x, bounds.max.x());
    const double to_z = std::min(edge.to_z, bounds.max.z());
    const bool outside = from_x > to_x || from_z > to_z;
    if (!outside) lines.push_back({point(from_x, from_z), point(to_x, to_z)});
  }
  return lines;
}

SceneBuilder::SceneBuilder(const WorldDefinition& world) : world_(world) {
  for (const Prototype& prototype : world.prototypes)
    mesh_of_prototype_.push_back(mesh_of(prototype.body.shape));

  statics_.has_ground = false;
  for (std::size_t i = 0; i < world.statics.size(); ++i) {
    const WorldStatic& piece = world.statics[i];
    if (std::holds_alternative<PlaneShape>(piece.body.shape)) {
      statics_.has_ground = true;
      statics_.ground_height_m = static_cast<float>(piece.body.position.y);
      statics_.ground_colour = to_rgb(piece.colour);
      continue;
    }
    statics_.instances.push_back({.sort_key = i + 1,
                                  .mesh = mesh_of(piece.body.shape),
                                  .colour = to_rgb(piece.colour),
                                  .position = piece.body.position.relative_to({}),
                                  .orientation = to_vector(piece.body.orientation)});
  }
  // The capsule's ends are its bounding sphere's, whatever its proportions.
  const Shape& avatar = world.prototypes.at(world.avatar.value).body.shape;
  eye_above_centre_m_ = static_cast<double>(bounding_radius(avatar)) - eye_below_top_m;
}

render::MeshIndex SceneBuilder::mesh_of(const Shape& shape) {
  std::vector<float> key;
  append_numbers(shape, key);
  const auto known = std::find(mesh_keys_.begin(), mesh_keys_.end(), key);
  if (known != mesh_keys_.end()) return static_cast<render::MeshIndex>(known - mesh_keys_.begin());
  mesh_keys_.push_back(std::move(key));
  meshes_.push_back({.shape = to_mesh_shape(shape), .marked = true});
  return static_cast<render::MeshIndex>(meshes_.size() - 1);
}

render::Scene SceneBuilder::build(std::span<const ReplicaPose> poses, bool tinted) const {
  render::Scene scene;
  scene.instances.reserve(poses.size());
  for (const ReplicaPose& pose : poses) {
    if (pose.prototype.value >= mesh_of_prototype_.size()) continue;
    const Colour own = pose.id.kind() == BodyId::Kind::avatar
                           ? player_colour(pose.id.player())
                           : world_.prototypes[pose.prototype.value].colour;
    scene.instances.push_back(
        {.sort_key = pose.id.value,
         .mesh = mesh_of_prototype_[pose.prototype.value],
         .colour = tinted ? tinted_by(own, region_colour(pose.owner)) : to_rgb(own),
         .position = pose.position.relative_to({}),
         .orientation = to_vector(pose.orientation)});
  }
  return scene;
}

WorldPosition SceneBuilder::eye(const WorldPosition& avatar) const {
  return {avatar.x, avatar.y + eye_above_centre_m_, avatar.z};
}

render::Camera SceneBuilder::avatar_camera(const ReplicaPose& pose, Look look) const {
  render::Camera camera;
  camera.eye = eye(pose.position).relative_to({});
  camera.yaw_rad = look.yaw;
  camera.pitch_rad = look.pitch;
  return camera;
}

render::Camera SceneBuilder::overview_camera() const {
  // The bounds reach far beyond what is worth looking at: what stands there says where to look.
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  const auto include = [&](const WorldPosition& p) {
    low = low.cwiseMin(p.vector());
    high = high.cwiseMax(p.vector());
  };
  for (const WorldBody& body : world_.bodies) include(body.state.position);
  for (const SpawnPoint& spawn : world_.spawn_points) include(spawn.position);
  if ((low.array() > high.array()).any()) low = high = Eigen::Vector3d::Zero();
  const Eigen::Vector3d centre = (low + high) / 2;
  const double extent = std::clamp((high - low).norm(), 20.0, 400.0);

  render::Camera camera;
  camera.eye =
      WorldPosition{centre.x(), centre.y() + 0.35 * extent, centre.z() + 0.6 * extent}.relative_to(
          {});
  camera.yaw_rad = 0;
  camera.pitch_rad = -0.5f;
  return camera;
}

}  // namespace aureole
