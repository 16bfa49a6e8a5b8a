// Distances by Bullet's GJK between the cores of two shapes, depths by its EPA once these overlap,
// or by separating axes where both are boxes.
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "server/base/check.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/bullet_shapes.h"
#include "server/physics/physics_world.h"
#include "server/physics/shape_probe.h"

namespace aureole {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
/// Shortest advance of a sweep: in metres, and as a share of the whole way.
constexpr double advance_min_m = 1e-3;
constexpr double advance_min_share = 1.0 / 256;

/// A convex piece of a shape.
struct Part {
  const btConvexShape* shape = nullptr;
  const btBoxShape* sharp = nullptr;  ///< The same without rounded edges; boxes only.
  btTransform local;
};

struct Placed {
  const btConvexShape& shape;
  const btTransform& pose;

  btVector3 farthest(const btVector3& direction) const {
    return pose(shape.localGetSupportVertexWithoutMarginNonVirtual(direction * pose.getBasis()));
  }
};

/// How far b lies beyond a along a unit vector, the better way round. The signed distance of two
/// convex shapes is the greatest of these over all directions: none can say too much.
float gap_along(const Placed& a, const Placed& b, const btVector3& n) {
  const auto beyond = [](const Placed& x, const Placed& y, const btVector3& direction) {
    return direction.dot(y.farthest(-direction) - x.farthest(direction));
  };
  return std::max(beyond(a, b, n), beyond(b, a, n)) - a.shape.getMarginNonVirtual() -
         b.shape.getMarginNonVirtual();
}

/// Signed distance as one of the algorithms finds it from a first guess at the direction, and that
/// direction; margins are round hulls around the cores.
float estimate(const Placed& a, const Placed& b, const btVector3& guess, btVector3& direction) {
  const float margins = a.shape.getMarginNonVirtual() + b.shape.getMarginNonVirtual();
  btGjkEpaSolver2::sResults found;
  const auto apart = [&] { return found.witnesses[1] - found.witnesses[0]; };
  direction = guess;
  if (btGjkEpaSolver2::Distance(&a.shape, a.pose, &b.shape, b.pose, guess, found)) {
    if (!apart().fuzzyZero()) direction = apart().normalized();
    return apart().length() - margins;
  }
  if (!btGjkEpaSolver2::Penetration(&a.shape, a.pose, &b.shape, b.pose, guess, found, true))
    return -margins;
  if (!apart().fuzzyZero()) direction = apart().normalized();
  return -apart().length();
}

/// Either algorithm now and then stops centimetres off. What it found is believed if its direction
/// bears it out; otherwise it starts again elsewhere, and in the end the best direction counts.
float convex_separation(const Placed& a, const Placed& b) {
  constexpr float believed_within_m = 5e-4f;
  const btVector3 towards = b.pose.getOrigin() - a.pose.getOrigin();
  const btVector3 up(0, 1, 0);
  const btVector3 first = towards.fuzzyZero() ? up : towards.normalized();
  float best = gap_along(a, b, first);
  for (const btVector3& guess : {first, -first, up, btVector3(1, 0, 0), btVector3(0, 0, 1),
                                 btVector3(-0.6f, 0.64f, 0.48f)}) {
    btVector3 direction;
    const float found = estimate(a, b, guess, direction);
    best = std::max(best, gap_along(a, b, direction));
    if (std::abs(found - best) <= believed_within_m) break;
  }
  return best;
}

/// Depth of two boxes' overlap by the separating axis theorem, which is exact where EPA loses
/// centimetres on parallel edges; negative or zero if they do not overlap.
float box_overlap(const btBoxShape& a, const btTransform& pose_a, const btBoxShape& b,
                  const btTransform& pose_b) {
  const btMatrix3x3& frame_a = pose_a.getBasis();
  const btMatrix3x3& frame_b = pose_b.getBasis();
  const btVector3 half_a = a.getHalfExtentsWithMargin();
  const btVector3 half_b = b.getHalfExtentsWithMargin();
  const btVector3 between = pose_b.getOrigin() - pose_a.getOrigin();
  float least = infinity;
  const auto try_axis = [&](const btVector3& axis) {
    if (axis.length2() < 1e-6f) return;  // the cross product of two parallel edges
    const btVector3 n = axis.normalized();
    const float reach_a = (n * frame_a).absolute().dot(half_a);
    const float reach_b = (n * frame_b).absolute().dot(half_b);
    least = std::min(least, reach_a + reach_b - std::abs(n.dot(between)));
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(frame_a.getColumn(i));
    try_axis(frame_b.getColumn(i));
    for (int j = 0; j < 3; ++j) try_axis(frame_a.getColumn(i).cross(frame_b.getColumn(j)));
  }
  return least;
}

float sharp_box_separation(const btBoxShape& a, const btTransform& pose_a, const btBoxShape& b,
                           const btTransform& pose_b) {
  const float overlap = box_overlap(a, pose_a, b, pose_b);
  return overlap > 0 ? -overlap : std::max(-overlap, convex_separation({a, pose_a}, {b, pose_b}));
}

}  // namespace

struct ShapeProbe::Impl {
  explicit Impl(std::span<const BodyDefinition> prototypes);

  void take_apart(const btCollisionShape& shape, const btTransform& local,
                  std::vector<Part>& parts);
  /// With a at `pose_a` and b at `pose_b`, both near the origin of one frame.
  float separation(PrototypeId a, const btTransform& pose_a, PrototypeId b,
                   const btTransform& pose_b) const;

  ShapeLibrary library;
  std::vector<std::unique_ptr<btBoxShape>> sharp_boxes;
  std::vector<std::vector<Part>> parts;  ///< By prototype.
  std::vector<double> radius_m;          ///< By prototype.
};

ShapeProbe::Impl::Impl(std::span<const BodyDefinition> prototypes)
    : library(prototypes, {}), parts(prototypes.size()) {
  for (std::size_t i = 0; i < prototypes.size(); ++i) {
    const PrototypeId id{static_cast<PrototypeId::rep>(i)};
    take_apart(*library.prototype(id).shape, btTransform::getIdentity(), parts[i]);
    radius_m.push_back(double{bounding_radius(prototypes[i].shape)});
  }
}

void ShapeProbe::Impl::take_apart(const btCollisionShape& shape, const btTransform& local,
                                  std::vector<Part>& into) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i)
      take_apart(*compound.getChildShape(i), local * compound.getChildTransform(i), into);
    return;
  }
  AUREOLE_CHECK(shape.isConvex(), "a body's shape is made of convex pieces");
  Part part{static_cast<const btConvexShape*>(&shape), nullptr, local};
  if (shape.getShapeType() == BOX_SHAPE_PROXYTYPE) {
    const auto& box = static_cast<const btBoxShape&>(shape);
    sharp_boxes.push_back(std::make_unique<btBoxShape>(box.getHalfExtentsWithMargin()));
    sharp_boxes.back()->setMargin(0);
    part.sharp = sharp_boxes.back().get();
  }
  into.push_back(part);
}

float ShapeProbe::Impl::separation(PrototypeId a, const btTransform& pose_a, PrototypeId b,
                                   const btTransform& pose_b) const {
  float nearest = infinity;
  for (const Part& x : parts[a.value]) {
    for (const Part& y : parts[b.value]) {
      const btTransform at_x = pose_a * x.local;
      const btTransform at_y = pose_b * y.local;
      nearest = std::min(nearest, x.sharp && y.sharp
                                      ? sharp_box_separation(*x.sharp, at_x, *y.sharp, at_y)
                                      : convex_separation({*x.shape, at_x}, {*y.shape, at_y}));
    }
  }
  return nearest;
}

ShapeProbe::ShapeProbe(std::span<const BodyDefinition> prototypes)
    : impl_(std::make_unique<Impl>(prototypes)) {}
ShapeProbe::~ShapeProbe() = default;
ShapeProbe::ShapeProbe(ShapeProbe&&) noexcept = default;
ShapeProbe& ShapeProbe::operator=(ShapeProbe&&) noexcept = default;

float ShapeProbe::separation(PrototypeId a, const BodyState& pose_a, PrototypeId b,
                             const BodyState& pose_b) const {
  AUREOLE_CHECK(a.value < impl_->parts.size() && b.value < impl_->parts.size(),
                "a body's prototype is in the probe's table");
  AUREOLE_CHECK(is_sane(pose_a) && is_sane(pose_b), "a pose is checked before it is measured");
  const double radii = impl_->radius_m[a.value] + impl_->radius_m[b.value];
  if (distance(pose_a.position, pose_b.position) > radii + double{reach_m}) return infinity;
  const btTransform at_origin(to_bullet(pose_a.orientation), btVector3(0, 0, 0));
  const btTransform beside(to_bullet(pose_b.orientation),
                           to_bullet(pose_b.position.relative_to(pose_a.position)));
  const float found = impl_->separation(a, at_origin, b, beside);
  return found > reach_m ? infinity : found;
}

std::optional<float> ShapeProbe::swept_contact(const Sweep& a, const Sweep& b, float slop_m) const {
  const auto in_table = [&](PrototypeId id) { return id.value < impl_->parts.size(); };
  AUREOLE_CHECK(in_table(a.prototype) && in_table(b.prototype),
                "a body's prototype is in the probe's table");
  AUREOLE_CHECK(is_sane(a.from) && is_sane(a.to) && is_sane(b.from) && is_sane(b.to),
                "a pose is checked before it is measured");
  AUREOLE_CHECK(slop_m >= 0, "slop is a depth");
  // In a frame that goes along with a, only b moves.
  const Eigen::Vector3d start = b.from.position.vector() - a.from.position.vector();
  const Eigen::Vector3d end = b.to.position.vector() - a.to.position.vector();
  const Eigen::Vector3d way = end - start;
  const double length = way.norm();
  const double radii = impl_->radius_m[a.prototype.value] + impl_->radius_m[b.prototype.value];
  const double nearest_at =
      length > 0 ? std::clamp(-start.dot(way) / (length * length), 0.0, 1.0) : 0.0;
  if ((start + nearest_at * way).norm() >= radii) return {};

  const btTransform pose_a(to_bullet(a.from.orientation), btVector3(0, 0, 0));
  btTransform pose_b(to_bullet(b.from.orientation), btVector3(0, 0, 0));
  const double least = std::max(advance_min_m, advance_min_share * length);
  // Conservative advancement: what is d apart cannot meet before one has gone d towards the other.
  for (double gone = 0;;) {
    const double t = length > 0 ? std::min(gone / length, 1.0) : 0.0;
    pose_b.setOrigin(to_bullet(Eigen::Vector3f((start + t * way).cast<float>())));
    const double gap =
        double{impl_->separation(a.prototype, pose_a, b.prototype, pose_b)} + double{slop_m};
    if (gap < 0) return static_cast<float>(t);
    if (gone >= length) return {};
    gone += std::max(gap, least);
  }
}

}  // namespace aureole
