// Real shapes through the probe; Bullet itself where the question is what Bullet would do.
#include "server/experiment/oracles/view/body_shapes.h"

namespace aureole {

BodyShapes::BodyShapes(const WorldDefinition& world) {
  for (const auto& prototype : world.prototypes) {
    definitions_.push_back(prototype.body);
    radii_.push_back(aureole::bounding_radius(prototype.body.shape));
  }
  probe_ = std::make_unique<ShapeProbe>(definitions_);
  physics_ = std::make_unique<PhysicsWorld>(world.physics, definitions_, no_statics_, 4);
}

double BodyShapes::separation(const SeenBody& a, const SeenBody& b) const {
  return probe_->separation(a.prototype, a.state, b.prototype, b.state);
}

bool BodyShapes::meet_between(const SeenBody& a_from, const SeenBody& a_to, const SeenBody& b_from,
                              const SeenBody& b_to, double slop_m) const {
  return probe_
      ->swept_contact({a_from.prototype, a_from.state, a_to.state},
                      {b_from.prototype, b_from.state, b_to.state}, static_cast<float>(slop_m))
      .has_value();
}

bool BodyShapes::collide_in_one_step(const SeenBody& a, const SeenBody& b) const {
  PhysicsWorld both = physics_->scratch(2);
  const NewBody bodies[] = {{a.id, a.prototype, a.state}, {b.id, b.prototype, b.state}};
  both.add(bodies);
  both.wake(a.id);
  both.wake(b.id);
  const Eigen::Vector3f before = a.state.linear_velocity - b.state.linear_velocity;
  both.step(tick_s);
  const Eigen::Vector3f after = both.state(a.id).linear_velocity - both.state(b.id).linear_velocity;
  // Gravity pulls both alike, and damping takes a thousandth: what changed more was a contact.
  constexpr float share = 0.05f;
  return (after - before).norm() > share * before.norm();
}

}  // namespace aureole
