// Bullet's pairs in the order of their proxies, kept from step to step.
#pragma once

#include <btBulletCollisionCommon.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aureole {

/// A walk over all pairs by the unique ids of their proxies, descending, which is what Bullet does
/// where `m_deterministicOverlappingPairs` is set: what a step does must not depend on how pairs
/// came to lie where they lie.
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
  /// Unique ids of both proxies, the lower one, which is the first one's, in the upper half.
  using Key = std::uint64_t;
  struct Place {
    Key key;
    std::uint32_t at;  ///< Where the pair is in Bullet's array.
    /// The pair's first one when last looked at, to be fetched; it may have gone.
    const btPersistentManifold* manifold;
  };

  void mend(const btBroadphasePairArray& pairs);
  void fetch_ahead(const btBroadphasePairArray& pairs, std::size_t n) const;
  void note_manifold(const btBroadphasePair& pair, Place& place);

  std::vector<Key> keys_;     ///< Of the pair at each place of Bullet's array, when last looked at.
  std::vector<Place> order_;  ///< Of all pairs, descending by keys.
  std::vector<Place> come_, merged_;  ///< Only used within mend(); kept for their memory.
  btManifoldArray manifolds_;         ///< Only used within note_manifold().
};

}  // namespace aureole
