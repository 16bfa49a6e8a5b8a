// Vectors, positions and orientations between the code's types and the wire's.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "protocol/quantise.h"
#include "protocol/wire.h"
#include "server/base/world_position.h"

namespace aureole {

inline wire::Vec3 to_wire(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}
inline wire::Vec3d to_wire(const WorldPosition& p) {
  return {p.x, p.y, p.z};
}
inline wire::Quat to_wire(const Eigen::Quaternionf& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

inline Eigen::Vector3f from_wire(const wire::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline WorldPosition from_wire(const wire::Vec3d& p) {
  return {p.x(), p.y(), p.z()};
}
inline Eigen::Quaternionf from_wire(const wire::Quat& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

/// Slots of replicas travel in three bytes.
inline constexpr std::uint32_t slot_codes = 1u << 24;
/// `slot` in its three bytes and `pose` behind it, written as whole words.
inline wire::ReplicaMotion motion_of(std::uint32_t slot, const QuantisedPose& pose) {
  static_assert(std::endian::native == std::endian::little);
  static_assert(sizeof(wire::ReplicaMotion) == 3 + QuantisedPose::size &&
                std::is_trivially_copyable_v<wire::ReplicaMotion>);
  const std::uint64_t first = slot | pose.low() << 24;
  const std::uint64_t second = pose.low() >> 40 | pose.high() << 24;
  const auto third = static_cast<std::uint16_t>(pose.high() >> 40);
  wire::ReplicaMotion motion;
  auto* bytes = reinterpret_cast<std::byte*>(&motion);
  std::memcpy(bytes, &first, 8);
  std::memcpy(bytes + 8, &second, 8);
  std::memcpy(bytes + 16, &third, 2);
  return motion;
}
inline std::uint32_t slot_of(const wire::ReplicaMotion& motion) {
  const std::uint8_t* bytes = motion.slot()->Data();
  return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16;
}

}  // namespace aureole
