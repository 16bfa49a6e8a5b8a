// Boxes for rest, for free flight, and for everything else.
#include "server/aura/adaptive/aura_size.h"

#include <algorithm>

namespace aureole {
namespace {

constexpr double gravity_mps2 = 9.81;
/// Share of its speed that a body in flight may be off its course (damping, spin, the solver).
constexpr double astray = 0.05;
/// Share of the speed towards the ground that friction may turn aside: friction 1 on either side.
constexpr double turned_by_friction = 0.5;
/// What has edges may trip over them on the ground.
constexpr double tripped = 0.5;

/// A turning body fills its bounding sphere sooner or later.
Eigen::Vector3d turning_extents(const HostedBody& body, double speed_mps, double reach_s) {
  const double sphere = body.bounding_radius_m;
  return body.half_extents.unaryExpr(
      [&](double half) { return std::max(half, std::min(sphere, half + speed_mps * reach_s)); });
}

}  // namespace

AuraBox resting_aura(const HostedBody& body) {
  AuraBox box{body.position.vector(), body.half_extents};
  box.half.array() += resting_margin_m;
  return box;
}

AuraBox flight_aura(const HostedBody& body, double reach_s) {
  const Eigen::Vector3d way = body.velocity_mps * reach_s;
  const double fall = 0.5 * gravity_mps2 * reach_s * reach_s;
  Eigen::Vector3d low = way.cwiseMin(0), high = way.cwiseMax(0);
  low.y() -= fall;
  double aside = resting_margin_m + astray * way.norm();
  if (body.near_ground) {
    aside += turned_by_friction * std::abs(way.y());
    if (!body.round) aside += tripped * std::hypot(way.x(), way.z());
    // It may bounce, and no higher than it came.
    high.y() = std::max(high.y(), -way.y());
  }
  const Eigen::Vector3d extents = turning_extents(body, body.surface_speed_mps, reach_s);
  AuraBox box;
  box.centre = body.position.vector() + 0.5 * (low + high);
  box.half = 0.5 * (high - low) + extents;
  box.half.array() += aside;
  return box;
}

AuraBox struck_aura(const HostedBody& body, double speed_mps, double reach_s) {
  const double fall = 0.5 * gravity_mps2 * reach_s * reach_s;
  AuraBox box{body.position.vector(), turning_extents(body, speed_mps, reach_s)};
  box.half.array() += resting_margin_m + speed_mps * reach_s;
  box.half.y() += fall;
  return box;
}

}  // namespace aureole
