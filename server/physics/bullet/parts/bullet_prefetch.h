// What walks read of Bullet's objects, asked for ahead. Wrong guesses cost time, no more.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cstddef>

#include "server/base/prefetch.h"

namespace aureole {

/// Whether an object is awake, which Bullet 3.24 keeps 248 bytes into it.
inline void prefetch_activation(const btCollisionObject* object) {
  constexpr std::size_t at = 248;
  prefetch(reinterpret_cast<const std::byte*>(object) + at);
}

/// Its pose, its shape and whether it is awake.
inline void prefetch_object(const btCollisionObject* object) {
  prefetch(object, 5 * cache_line);
}

/// What comes after a manifold's contact points: whose it is, how many they are, how far they may
/// be apart. Bullet 3.24 keeps that in the 32 bytes before this. Manifolds begin at any multiple of
/// 16 bytes, and in half of them that is in two lines of memory.
inline void prefetch_point_count(const btPersistentManifold* manifold) {
  constexpr std::size_t before = 32;
  prefetch(reinterpret_cast<const std::byte*>(&manifold->m_companionIdA) - before, before + 1);
}

/// Its contact points. Requires that it is there, and its number of points near.
inline void prefetch_points(const btPersistentManifold& manifold) {
  const auto count = static_cast<std::size_t>(manifold.getNumContacts());
  if (count > 0) prefetch(&manifold.getContactPoint(0), count * sizeof(btManifoldPoint));
}

/// What comes after its points, and its first two points.
inline void prefetch_manifold(const btPersistentManifold* manifold) {
  constexpr std::size_t points_size = 2 * sizeof(btManifoldPoint);
  prefetch(manifold, sizeof(btTypedObject) + points_size);
  prefetch_point_count(manifold);
}

}  // namespace aureole
