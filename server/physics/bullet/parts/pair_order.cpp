// Mends the order of pairs, and walks through them in it.
#include "server/physics/bullet/parts/pair_order.h"

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <algorithm>

#include "server/base/check.h"
#include "server/physics/bullet/bullet_body.h"
#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// How many pairs lie between asking for something and reading it. Between two and eight of them no
/// difference was measured.
constexpr std::size_t ahead = 4;

/// Of the largest algorithm that our shapes need.
constexpr std::size_t algorithm_size = sizeof(btConvexConvexAlgorithm);

bool is_awake(const btBroadphaseProxy* proxy) {
  return object_of(proxy)->isActive();
}

}  // namespace

void PairOrder::mend(const btBroadphasePairArray& pairs) {
  const auto count = static_cast<std::size_t>(pairs.size());
  const auto pair = [&](std::size_t at) -> const btBroadphasePair& {
    return pairs[static_cast<int>(at)];
  };
  const std::size_t known = std::min(keys_.size(), count);
  bool some_went = keys_.size() > count;
  keys_.resize(count);
  come_.clear();
  for (std::size_t at = 0; at < count; ++at) {
    if (at + 2 * ahead < count) {
      prefetch(&pair(at + 2 * ahead).m_pProxy0->m_uniqueId);
      prefetch(&pair(at + 2 * ahead).m_pProxy1->m_uniqueId);
    }
    const PairKey key(*pair(at).m_pProxy0, *pair(at).m_pProxy1);
    if (at < known && keys_[at] == key) continue;
    some_went = some_went || at < known;
    keys_[at] = key;
    come_.push_back({key, static_cast<std::uint32_t>(at), nullptr});
  }
  // Bullet puts its last pair where one is taken out: that one counts as gone and come again.
  if (some_went)
    std::erase_if(order_, [&](const Place& place) {
      return place.at >= count || keys_[place.at] != place.key;
    });
  if (!come_.empty()) {
    const auto before = [](const Place& a, const Place& b) { return a.key < b.key; };
    std::sort(come_.begin(), come_.end(), before);
    merged_.resize(order_.size() + come_.size());
    std::merge(order_.begin(), order_.end(), come_.begin(), come_.end(), merged_.begin(), before);
    order_.swap(merged_);
  }
  AUREOLE_CHECK(order_.size() == count, "every pair has one place");
}

void PairOrder::fetch_ahead(const btBroadphasePairArray& pairs, std::size_t n) const {
  const std::size_t count = order_.size();
  const auto pair = [&](std::size_t m) -> const btBroadphasePair& {
    return pairs[static_cast<int>(order_[m].at)];
  };
  // Each thing is found through the one that has been asked for before it.
  if (const std::size_t m = n + 4 * ahead; m < count) prefetch(&pair(m));
  if (const std::size_t m = n + 3 * ahead; m < count) {
    prefetch(pair(m).m_pProxy0);
    prefetch(pair(m).m_pProxy1);
  }
  if (const std::size_t m = n + 2 * ahead; m < count) {
    prefetch_activation(object_of(pair(m).m_pProxy0));
    prefetch_activation(object_of(pair(m).m_pProxy1));
  }
  if (const std::size_t m = n + ahead; m < count) {
    // Nobody looks at the contacts of two who sleep, nor at their poses.
    if (!is_awake(pair(m).m_pProxy0) && !is_awake(pair(m).m_pProxy1)) return;
    prefetch_object(object_of(pair(m).m_pProxy0));
    prefetch_object(object_of(pair(m).m_pProxy1));
    if (pair(m).m_algorithm != nullptr) prefetch(pair(m).m_algorithm, algorithm_size);
    if (order_[m].manifold != nullptr) prefetch_manifold(order_[m].manifold);
  }
}

void PairOrder::note_manifold(const btBroadphasePair& pair, Place& place) {
  if (place.manifold != nullptr || pair.m_algorithm == nullptr) return;
  manifolds_.resize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds_);
  if (manifolds_.size() > 0) place.manifold = manifolds_[0];
}

void PairOrder::walk(btBroadphasePairArray& pairs, btOverlapCallback& visit) {
  mend(pairs);
  const int count = pairs.size();
  for (std::size_t n = 0; n < order_.size(); ++n) {
    fetch_ahead(pairs, n);
    btBroadphasePair& pair = pairs[static_cast<int>(order_[n].at)];
    const bool is_over = visit.processOverlap(pair);
    AUREOLE_CHECK(!is_over && pairs.size() == count, "pairs come and go where boxes are moved");
    note_manifold(pair, order_[n]);
  }
}

}  // namespace aureole
