// Bullet's pairs: what is taken out as a group, and the order of a step's walk.
#pragma once

#include <btBulletCollisionCommon.h>

#include "server/physics/bullet/parts/pair_order.h"

namespace aureole {

/// Bullet scans all pairs twice for each removed body. A group's pairs are taken out in one pass
/// beforehand, and then there is nothing to scan for. A step walks through pairs in the order that
/// `m_deterministicOverlappingPairs` asks for; see PairOrder.
class PairCache : public btHashedOverlappingPairCache {
 public:
  void cleanProxyFromPairs(btBroadphaseProxy*, btDispatcher*) override {}
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy*, btDispatcher*) override {}

  using btHashedOverlappingPairCache::processAllOverlappingPairs;
  void processAllOverlappingPairs(btOverlapCallback* callback, btDispatcher*,
                                  const btDispatcherInfo&) override {
    order_.walk(getOverlappingPairArray(), *callback);
  }

 private:
  PairOrder order_;
};

}  // namespace aureole
