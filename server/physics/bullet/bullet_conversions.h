// Between Eigen's and Bullet's vectors, bit for bit; inside this room only.
#pragma once

#include <LinearMath/btQuaternion.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace aureole {

inline btVector3 to_bullet(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}
inline Eigen::Vector3f from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline btQuaternion to_bullet(const Eigen::Quaternionf& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}
inline Eigen::Quaternionf from_bullet(const btQuaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace aureole
