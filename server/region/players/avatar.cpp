// How avatars walk, jump and carry: velocities steered within bounded accelerations.
#include "server/region/players/avatar.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

Eigen::Vector3f walking_direction(const Avatar& avatar) {
  const Eigen::Vector3f forward(-std::sin(avatar.yaw), 0, -std::cos(avatar.yaw));
  const Eigen::Vector3f right(std::cos(avatar.yaw), 0, -std::sin(avatar.yaw));
  Eigen::Vector3f direction(0, 0, 0);
  if (avatar.keys & keys::forward) direction += forward;
  if (avatar.keys & keys::back) direction -= forward;
  if (avatar.keys & keys::right) direction += right;
  if (avatar.keys & keys::left) direction -= right;
  const float length = direction.norm();
  if (length < 1e-3f) return Eigen::Vector3f(0, 0, 0);
  return direction / length;
}

void walk(PhysicsWorld& world, const Avatar& avatar, const AvatarTuning& tuning) {
  const BodyId id = avatar.body();
  const Eigen::Vector3f direction = walking_direction(avatar);
  const bool wants_jump = (avatar.keys & keys::jump) != 0;
  if (world.is_asleep(id) && direction.isZero() && !wants_jump) return;

  BodyState state = world.state(id);
  const bool supported = world.is_supported(id);
  const float speed = (avatar.keys & keys::sprint) ? tuning.sprint_mps : tuning.walk_mps;
  Eigen::Vector3f change = direction * speed - state.linear_velocity;
  change.y() = 0;
  const float acceleration =
      supported ? tuning.ground_acceleration_mps2 : tuning.air_acceleration_mps2;
  // In the air without keys the flight goes on as it was.
  if (!supported && direction.isZero()) change.setZero();
  const float change_max = acceleration * tick_s;
  if (change.norm() > change_max) change *= change_max / change.norm();
  if (wants_jump && supported && state.linear_velocity.y() < 1.0f)
    change.y() = tuning.jump_mps - state.linear_velocity.y();
  // Nothing to do for one who stands: touching the velocity would keep it awake for ever.
  if (direction.isZero() && change.norm() < 0.02f) return;
  world.set_velocity(id, state.linear_velocity + change, Eigen::Vector3f::Zero());
}

bool carry(PhysicsWorld& world, const Avatar& avatar, const AvatarTuning& tuning,
           float half_height) {
  const BodyState holder = world.state(avatar.body());
  const BodyState held = world.state(avatar.carried);
  const Eigen::Vector3d eye =
      holder.position.vector() + Eigen::Vector3d(0, half_height - tuning.eye_below_top_m, 0);
  const Eigen::Vector3d hand =
      eye + (look_direction(avatar.yaw, avatar.pitch) * avatar.carried_distance_m).cast<double>();
  const Eigen::Vector3f gap = (hand - held.position.vector()).cast<float>();
  if (gap.norm() > tuning.carry_reach_m) return false;
  // Who stands on what they carry would lift themselves into the sky.
  const auto touched = world.touching(avatar.body());
  const bool underfoot = held.position.y < holder.position.y - 0.6 * half_height;
  if (underfoot && std::binary_search(touched.begin(), touched.end(), avatar.carried)) return false;

  Eigen::Vector3f velocity = gap * tuning.carry_gain_per_s;
  if (velocity.norm() > tuning.carry_speed_max_mps)
    velocity *= tuning.carry_speed_max_mps / velocity.norm();
  velocity += holder.linear_velocity;
  world.set_velocity(avatar.carried, velocity, held.angular_velocity * 0.85f);
  return true;
}

}  // namespace

Eigen::Vector3f look_direction(float yaw, float pitch) {
  return {-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch)};
}

float avatar_half_height(const BodyDefinition& definition) {
  if (const auto* capsule = std::get_if<CapsuleShape>(&definition.shape))
    return capsule->height / 2;
  return bounding_radius(definition.shape);
}

bool drive_avatar(PhysicsWorld& world, const Avatar& avatar, const AvatarTuning& tuning,
                  float half_height) {
  walk(world, avatar, tuning);
  if (avatar.carried == BodyId{} || !world.contains(avatar.carried)) return true;
  return carry(world, avatar, tuning, half_height);
}

}  // namespace aureole
