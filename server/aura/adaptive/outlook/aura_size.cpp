// Rooms for rest, for free flight, and for everything else.
#include "server/aura/adaptive/outlook/aura_size.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

/// How much faster than expected a body may get meanwhile (the solver parting shapes).
constexpr double faster = 1.1;
/// Share of its speed that a body in flight may be off its course (damping, spin, the solver).
constexpr double astray = 0.05;
/// Share of the speed towards the ground that friction may turn aside: friction 1 on either side.
constexpr double turned_by_friction = 0.5;
/// What has edges may trip over them on the ground.
constexpr double tripped = 0.5;

double fall_m(double duration_s) {
  return 0.5 * gravity_mps2 * duration_s * duration_s;
}

/// How far gravity may carry the body, whichever way it is turned. On level ground only what can
/// still sink, by falling over, gets any faster: what has come down by h is as fast as sqrt(2 g h).
double sinks_m(const HostedBody& body, double duration_s) {
  const double falls_m = fall_m(duration_s);
  const double drop_m = std::max(0.0, body.ground_gap_m + body.half_extents.y() - body.lowest_m);
  if (drop_m >= falls_m) return falls_m;
  const double down_s = std::sqrt(2 * drop_m / gravity_mps2);
  return drop_m + gravity_mps2 * down_s * (duration_s - down_s);
}

// To be multiplied with, axis by axis. Vectors of which one number has just been written are not
// put together for it: a processor cannot read two of their numbers at once without waiting.
const Eigen::Array3d upwards(0, 1, 0), over_the_ground(1, 0, 1), everywhere(1, 1, 1);

Eigen::Vector3d level(const Eigen::Vector3d& v) {
  return v.array() * over_the_ground;
}

/// How fast a body that comes down at `falling_mps` may leave the ground again in whatever
/// direction, apart from going on as it was.
double thrown_off_mps(const HostedBody& body, double falling_mps) {
  return (turned_by_friction + body.restitution) * falling_mps +
         (body.round ? 0.0 : tripped * level(body.velocity_mps).norm());
}

/// A turning body fills its bounding sphere sooner or later.
Eigen::Vector3d turning_extents(const HostedBody& body, double speed_mps, double reach_s) {
  const double sphere = body.bounding_radius_m;
  return body.half_extents.unaryExpr(
      [&](double half) { return std::max(half, std::min(sphere, half + speed_mps * reach_s)); });
}

double distance_m(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                  const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double length2 = along.squaredNorm();
  const double share =
      length2 > 0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (from + share * along - point).norm();
}

/// Along its way, down to the ground and then on over it, with room for all that it may turn to.
AuraCapsule swept(const HostedBody& body, double reach_s) {
  const double radius = body.round ? body.girth_m : body.bounding_radius_m;
  const double air = std::max(0.0, body.ground_gap_m + body.half_extents.y() - radius);
  const double up_mps = body.velocity_mps.y();
  const double falling_mps = std::sqrt(up_mps * up_mps + 2 * gravity_mps2 * air);
  const double flies_s = std::min(reach_s, (up_mps + falling_mps) / gravity_mps2);
  const double slides_s = reach_s - flies_s;
  const Eigen::Vector3d from = body.position.vector();
  const Eigen::Vector3d bend =
      (from + body.velocity_mps * flies_s).array() - fall_m(flies_s) * upwards;
  const Eigen::Array3d& onwards = slides_s > 0 ? over_the_ground : everywhere;
  const Eigen::Vector3d to = bend.array() + body.velocity_mps.array() * onwards * slides_s;
  AuraCapsule room;
  room.centre = 0.5 * (from + to);
  room.half_spine = 0.5 * (to - from);
  room.girth_m = radius + resting_margin_m + astray * body.velocity_mps.norm() * reach_s +
                 distance_m(bend, from, to) + 0.25 * fall_m(flies_s) +
                 (slides_s > 0 ? thrown_off_mps(body, falling_mps) * slides_s : 0.0);
  return room;
}

}  // namespace

AuraCapsule room_of(const HostedBody& body) {
  return {body.position.vector(), body.half_spine, body.girth_m};
}

AuraCapsule resting_aura(const HostedBody& body) {
  AuraCapsule aura = room_of(body);
  aura.girth_m += resting_margin_m;
  return aura;
}

AuraCapsule struck_aura(const HostedBody& body, const AuraCapsule& before, double way_m,
                        double reach_s) {
  AuraCapsule aura = before;
  aura.girth_m += faster * way_m + sinks_m(body, reach_s);
  return aura;
}

AuraCapsule smaller(const AuraCapsule& a, const AuraCapsule& b) {
  // Seen from above: most things stand on the ground.
  const auto size = [](const AuraCapsule& room) {
    return room.girth_m * (room.girth_m + room.half_spine.norm());
  };
  return size(a) < size(b) ? a : b;
}

AuraCapsule flight_aura(const HostedBody& body, double reach_s) {
  const AuraCapsule anywhere =
      struck_aura(body, resting_aura(body), body.motion_speed_mps * reach_s, reach_s);
  return smaller(swept(body, reach_s), anywhere);
}

AuraBox way_of(const HostedBody& body, double duration_s) {
  const Eigen::Vector3d way = body.velocity_mps * duration_s;
  const Eigen::Vector3d low = way.cwiseMin(0).array() - fall_m(duration_s) * upwards;
  Eigen::Vector3d high = way.cwiseMax(0);
  double aside = resting_margin_m + astray * way.norm();
  if (std::isfinite(body.ground_gap_m)) {
    aside += turned_by_friction * std::abs(way.y());
    if (!body.round) aside += tripped * level(way).norm();
    // It may bounce, and no higher than it came.
    high = high.array().max(-way.y() * upwards);
  }
  const Eigen::Vector3d extents = turning_extents(body, body.motion_speed_mps, duration_s);
  AuraBox box;
  box.centre = body.position.vector() + 0.5 * (low + high);
  box.half = 0.5 * (high - low) + extents;
  box.half.array() += aside;
  return box;
}

}  // namespace aureole
