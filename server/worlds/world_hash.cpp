// One number for a whole world: servers that disagree in anything that matters refuse each other.
#include "server/base/hash.h"
#include "server/worlds/reading/world_parts.h"

namespace aureole {
namespace {

/// Feeds values with lengths before texts and lists, and -0 as 0, so that equal worlds hash equally
/// and nothing can slide from one field into the next.
struct WorldHasher {
  Hasher h;
  void number(double v) { h.add(v + 0.0); }
  void count(std::size_t n) { h.add(static_cast<std::uint64_t>(n)); }
  void text(const std::string& s) { count(s.size()), h.text(s); }
  template <class Vector>
  void vector(const Vector& v) {
    for (int i = 0; i < v.size(); ++i) number(v[i]);
  }
  void point(const WorldPosition& p) { number(p.x), number(p.y), number(p.z); }
  void box(const Box3& b) { vector(b.min), vector(b.max); }
  void colour(Colour c) { h.add(c.r).add(c.g).add(c.b); }
  void settings(const WorldDefinition& w);
  void statics_and_prototypes(const WorldDefinition& w);
  void bodies(const WorldDefinition& w);
  void injectors(const WorldDefinition& w);
};

void WorldHasher::settings(const WorldDefinition& w) {
  text(w.name), text(w.description);
  vector(w.physics.gravity);
  h.add(w.physics.solver_iterations);
  number(w.physics.sleep_linear_speed), number(w.physics.sleep_angular_speed),
      number(w.physics.sleep_after_s);
  point(w.physics.origin);
  number(w.tolerances.speed_mps), number(w.tolerances.latency_ms),
      number(w.tolerances.frame_time_ms);
  h.add(static_cast<std::uint8_t>(w.mode));
  count(w.regions.size());
  for (const RegionDefinition& r : w.regions) {
    text(r.name);
    number(r.area.min_x), number(r.area.min_z), number(r.area.max_x), number(r.area.max_z);
  }
  box(w.bounds);
  h.add(w.max_bodies).add(w.max_thrown_per_player);
}

void WorldHasher::statics_and_prototypes(const WorldDefinition& w) {
  count(w.prototypes.size());
  for (const Prototype& p : w.prototypes)
    text(p.name), text(canonical_bytes(p.body)), colour(p.colour);
  count(w.statics.size());
  for (const WorldStatic& s : w.statics) {
    text(s.name), text(canonical_bytes(s.body.shape)), point(s.body.position);
    vector(s.body.orientation.coeffs());
    number(s.body.friction), number(s.body.restitution), colour(s.colour);
  }
}

void WorldHasher::bodies(const WorldDefinition& w) {
  count(w.bodies.size());
  for (const WorldBody& b : w.bodies) {
    h.add(b.prototype.value);
    point(b.state.position), vector(b.state.orientation.coeffs());
    vector(b.state.linear_velocity), vector(b.state.angular_velocity);
    h.add(static_cast<std::uint8_t>(b.state.activation));
    number(b.state.deactivation_time_s);
    h.add(b.host ? std::int32_t{b.host->value} : -1);
  }
  count(w.body_groups.size());
  for (const BodyGroup& g : w.body_groups) text(g.name), h.add(g.first).add(g.count);
}

void WorldHasher::injectors(const WorldDefinition& w) {
  count(w.injectors.size());
  for (const Injector& i : w.injectors) {
    text(i.name), number(i.rate_per_s), box(i.volume);
    vector(i.velocity_min), vector(i.velocity_max);
    count(i.mix.size());
    for (const auto& share : i.mix) h.add(share.prototype.value), number(share.weight);
    h.add(i.seed);
    number(i.start_s), number(i.duration_s);
  }
}

}  // namespace

std::uint64_t world_hash(const WorldDefinition& w) {
  WorldHasher hasher;
  hasher.settings(w);
  hasher.statics_and_prototypes(w);
  hasher.bodies(w);
  hasher.injectors(w);
  hasher.count(w.spawn_points.size());
  for (const SpawnPoint& s : w.spawn_points) hasher.point(s.position), hasher.number(s.yaw_rad);
  for (const Throwable& t : w.throwables) {
    hasher.text(t.name), hasher.h.add(t.prototype.value), hasher.number(t.speed_mps);
  }
  hasher.h.add(w.avatar.value);
  return hasher.h.value();
}

}  // namespace aureole
