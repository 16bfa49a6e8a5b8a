// Volumes and centres of mass by closed forms and by tetrahedra; reach by support functions.
#include "server/worlds/reading/shape_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "server/base/check.h"

namespace aureole {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct Face {
  std::array<std::size_t, 3> corners;
  Vector3d normal;  ///< Unit length, outwards.
  double offset;
};

Face face_of(const std::vector<Vector3d>& p, std::size_t a, std::size_t b, std::size_t c) {
  const Vector3d normal = (p[b] - p[a]).cross(p[c] - p[a]).normalized();
  return {{a, b, c}, normal, normal.dot(p[a])};
}

/// Four corners that span a volume, or nothing.
std::optional<std::array<std::size_t, 4>> first_tetrahedron(const std::vector<Vector3d>& p,
                                                            double flat) {
  const auto farthest = [&](auto distance) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < p.size(); ++i) {
      if (distance(p[i]) > distance(p[best])) best = i;
    }
    return std::pair(best, distance(p[best]));
  };
  const auto [b, length] = farthest([&](const Vector3d& q) { return (q - p[0]).norm(); });
  if (length <= flat) return {};
  const Vector3d along = (p[b] - p[0]).normalized();
  const auto [c, width] =
      farthest([&](const Vector3d& q) { return (q - p[0]).cross(along).norm(); });
  if (width <= flat) return {};
  const Vector3d normal = along.cross(p[c] - p[0]).normalized();
  const auto [d, depth] =
      farthest([&](const Vector3d& q) { return std::abs((q - p[0]).dot(normal)); });
  if (depth <= flat) return {};
  return std::array<std::size_t, 4>{0, b, c, d};
}

std::vector<Face> hull_faces(const std::vector<Vector3d>& p, const std::array<std::size_t, 4>& t,
                             double flat) {
  const Vector3d inside = (p[t[0]] + p[t[1]] + p[t[2]] + p[t[3]]) / 4;
  const auto outward = [&](std::size_t a, std::size_t b, std::size_t c) {
    Face face = face_of(p, a, b, c);
    return face.normal.dot(inside) > face.offset ? face_of(p, a, c, b) : face;
  };
  std::vector<Face> faces{outward(t[0], t[1], t[2]), outward(t[0], t[1], t[3]),
                          outward(t[0], t[2], t[3]), outward(t[1], t[2], t[3])};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto sees = [&](const Face& f) { return f.normal.dot(p[i]) > f.offset + flat; };
    std::set<std::pair<std::size_t, std::size_t>> edges;  // of the faces that the point sees
    for (const Face& f : faces) {
      if (!sees(f)) continue;
      for (std::size_t k = 0; k < 3; ++k) edges.emplace(f.corners[k], f.corners[(k + 1) % 3]);
    }
    std::erase_if(faces, sees);
    for (const auto& [a, b] : edges) {
      // An edge whose twin is hidden lies on the horizon.
      if (!edges.contains({b, a})) faces.push_back(face_of(p, a, b, i));
    }
  }
  return faces;
}

VolumeAndCentre of_compound(const CompoundShape& compound) {
  VolumeAndCentre sum;
  for (const auto& child : compound.children) {
    const VolumeAndCentre part = volume_and_centre(*child.shape);
    const Vector3d centre =
        child.position.cast<double>() + child.orientation.cast<double>() * part.centre;
    sum.volume_m3 += part.volume_m3;
    sum.centre += centre * part.volume_m3;
  }
  if (sum.volume_m3 > 0) sum.centre /= sum.volume_m3;
  return sum;
}

struct Volume {
  VolumeAndCentre operator()(const SphereShape& s) const {
    return {4.0 / 3.0 * std::numbers::pi * std::pow(double{s.radius}, 3), Vector3d::Zero()};
  }
  VolumeAndCentre operator()(const BoxShape& s) const {
    return {8.0 * s.half_extents.cast<double>().prod(), Vector3d::Zero()};
  }
  VolumeAndCentre operator()(const CapsuleShape& s) const {
    const double r = s.radius;
    return {std::numbers::pi * r * r * (s.height - 2 * r + 4.0 / 3.0 * r), Vector3d::Zero()};
  }
  VolumeAndCentre operator()(const CylinderShape& s) const {
    return {std::numbers::pi * s.radius * s.radius * s.height, Vector3d::Zero()};
  }
  VolumeAndCentre operator()(const ConvexHullShape& s) const {
    const auto found = convex_hull_volume(s.points);
    // Readers refuse flat hulls; moving one to its centre of mass may round it flat all the same.
    return found.value_or(VolumeAndCentre{});
  }
  VolumeAndCentre operator()(const CompoundShape& s) const { return of_compound(s); }
  VolumeAndCentre operator()(const PlaneShape&) const {
    AUREOLE_CHECK(false, "a plane has no volume");
    return {};
  }
};

/// How far a shape reaches from its origin along a direction of unit length in its own frame.
struct Support {
  Vector3f direction;
  float across() const { return std::hypot(direction.x(), direction.z()); }

  float operator()(const SphereShape& s) const { return s.radius; }
  float operator()(const BoxShape& s) const { return s.half_extents.dot(direction.cwiseAbs()); }
  float operator()(const CapsuleShape& s) const {
    return s.radius + (s.height / 2 - s.radius) * std::abs(direction.y());
  }
  float operator()(const CylinderShape& s) const {
    return s.radius * across() + s.height / 2 * std::abs(direction.y());
  }
  float operator()(const ConvexHullShape& s) const {
    float best = -std::numeric_limits<float>::infinity();
    for (const Vector3f& p : s.points) best = std::max(best, p.dot(direction));
    return best;
  }
  float operator()(const CompoundShape& s) const {
    float best = -std::numeric_limits<float>::infinity();
    for (const auto& child : s.children) {
      const Vector3f turned = child.orientation.conjugate() * direction;
      const auto& shape = static_cast<const Shape::variant&>(*child.shape);
      best = std::max(best, child.position.dot(direction) + std::visit(Support{turned}, shape));
    }
    return best;
  }
  float operator()(const PlaneShape&) const {
    AUREOLE_CHECK(false, "a plane reaches without end");
    return 0;
  }
};

}  // namespace

std::optional<VolumeAndCentre> convex_hull_volume(std::span<const Vector3f> points) {
  std::vector<Vector3d> p;
  double extent = 0;
  for (const Vector3f& point : points) {
    p.push_back(point.cast<double>());
    extent = std::max(extent, (p.back() - p.front()).norm());
  }
  const auto corners = p.size() < 4 ? std::nullopt : first_tetrahedron(p, extent * 1e-5);
  if (!corners) return {};
  VolumeAndCentre sum;
  for (const Face& f : hull_faces(p, *corners, extent * 1e-9)) {
    const Vector3d a = p[f.corners[0]] - p[0], b = p[f.corners[1]] - p[0],
                   c = p[f.corners[2]] - p[0];
    const double volume = a.cross(b).dot(c) / 6;
    sum.volume_m3 += volume;
    sum.centre += volume * (a + b + c) / 4;
  }
  if (!(sum.volume_m3 > 0)) return {};
  sum.centre = sum.centre / sum.volume_m3 + p[0];
  return sum;
}

VolumeAndCentre volume_and_centre(const Shape& shape) {
  return std::visit(Volume{}, static_cast<const Shape::variant&>(shape));
}

Reach reach_of(const Shape& shape, const Eigen::Quaternionf& orientation) {
  Reach reach;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3f direction = orientation.conjugate() * Vector3f::Unit(axis);
    const auto& alternatives = static_cast<const Shape::variant&>(shape);
    reach.max[axis] = std::visit(Support{direction}, alternatives);
    reach.min[axis] = -std::visit(Support{Vector3f(-direction)}, alternatives);
  }
  return reach;
}

}  // namespace aureole
