// Bullet's pairs in the order of their proxies, kept from step to step.
#pragma once

#include <btBulletCollisionCommon.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/physics/bullet/parts/pair_key.h"

namespace aureole {

/// A walk over all pairs in the order of their keys, which is Bullet's where
/// `m_deterministicOverlappingPairs` is set: what a step does must not depend on how pairs came to
/// lie where they lie.
///
/// Bullet sorts all pairs anew in every step, though hardly any has come or gone since the last
/// one; here the order is mended. And from each pair on it waits for memory again and again: for
/// the pair, its proxies, their objects, its algorithm, its manifold. Here all of these are asked
/// for while pairs before it are worked on.
class PairOrder {
 public:
  /// Calls `visit` for every pair, which neither adds nor removes any. No two pairs are alike.
  void walk(btBroadphasePairArray& pairs, btOverlapCallback& visit);

 private:
  struct Place {
    PairKey key;
    std::uint32_t at = 0;  ///< Where the pair is in Bullet's array.
    /// The first one that was seen of the pair. It may be long gone: it is fetched, never read.
    const btPersistentManifold* manifold = nullptr;
  };

  void mend(const btBroadphasePairArray& pairs);
  void fetch_ahead(const btBroadphasePairArray& pairs, std::size_t n) const;
  void note_manifold(const btBroadphasePair& pair, Place& place);

  std::vector<PairKey> keys_;  ///< Of the pair at each place of Bullet's array, as last seen.
  std::vector<Place> order_;   ///< Of all pairs, by their keys.
  std::vector<Place> come_, merged_;  ///< Only used within mend(); kept for their memory.
  btManifoldArray manifolds_;         ///< Only used within note_manifold().
};

}  // namespace aureole
