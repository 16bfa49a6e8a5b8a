// Vectors, positions and orientations between the code's types and the wire's.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

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

}  // namespace aureole
