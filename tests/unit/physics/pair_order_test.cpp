// The order in which pairs are walked through, against sorting them.
#include <algorithm>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "server/physics/bullet/pair_order.h"
#include "tests/support/catch.h"

namespace aureole {
namespace {

using Ids = std::pair<int, int>;

Ids ids_of(const btBroadphasePair& pair) {
  return {pair.m_pProxy0->m_uniqueId, pair.m_pProxy1->m_uniqueId};
}

/// Never touches anything; has one manifold, or none.
class Algorithm : public btCollisionAlgorithm {
 public:
  void processCollision(const btCollisionObjectWrapper*, const btCollisionObjectWrapper*,
                        const btDispatcherInfo&, btManifoldResult*) override {}
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray& found) override {
    ++asked;
    if (manifold) found.push_back(manifold.get());
  }
  std::unique_ptr<btPersistentManifold> manifold;
  int asked = 0;
};

class Walked : public btOverlapCallback {
 public:
  bool processOverlap(btBroadphasePair& pair) override {
    ids.push_back(ids_of(pair));
    return false;
  }
  std::vector<Ids> ids;
};

/// Pairs in an array like Bullet's, where the last one takes the place of whoever is taken out.
struct Pairs {
  Pairs() {
    for (int id = 1; id <= 40; ++id) {
      objects.push_back(std::make_unique<btCollisionObject>());
      auto proxy = std::make_unique<btBroadphaseProxy>();
      proxy->m_clientObject = objects.back().get();
      // Neither by age nor by address.
      proxy->m_uniqueId = id * 7 % 41;
      proxy->m_collisionFilterGroup = proxy->m_collisionFilterMask = 1;
      proxies.push_back(std::move(proxy));
    }
  }
  bool contains(Ids ids) const {
    for (int i = 0; i < array.size(); ++i)
      if (ids_of(array[i]) == ids) return true;
    return false;
  }
  void add(std::size_t a, std::size_t b) {
    const btBroadphasePair pair(*proxies[a], *proxies[b]);
    if (a != b && !contains(ids_of(pair))) array.push_back(pair);
  }
  void remove(int at) {
    array.swap(at, array.size() - 1);
    array.pop_back();
  }
  std::vector<Ids> sorted() const {
    std::vector<Ids> ids;
    for (int i = 0; i < array.size(); ++i) ids.push_back(ids_of(array[i]));
    std::sort(ids.rbegin(), ids.rend());
    return ids;
  }
  std::vector<Ids> walk() {
    Walked walked;
    order.walk(array, walked);
    return walked.ids;
  }

  std::vector<std::unique_ptr<btCollisionObject>> objects;
  std::vector<std::unique_ptr<btBroadphaseProxy>> proxies;
  btBroadphasePairArray array;
  PairOrder order;
};

TEST_CASE("Pairs are walked through by the ids of their proxies, whoever comes and goes") {
  Pairs pairs;
  CHECK(pairs.walk().empty());
  std::mt19937 random(5);
  for (int step = 0; step < 400; ++step) {
    // Some steps change nothing, some nearly everything; every hundredth begins anew.
    const std::size_t changes = step % 3 == 0 ? 0 : random() % (step % 7 == 0 ? 60 : 4);
    for (std::size_t n = 0; n < changes; ++n) {
      if (pairs.array.size() > 0 && random() % 2 == 0)
        pairs.remove(static_cast<int>(random() % static_cast<unsigned>(pairs.array.size())));
      else
        pairs.add(random() % 40, random() % 40);
    }
    if (step % 100 == 99) pairs.array.resize(0);
    INFO("step " << step << ", " << pairs.array.size() << " pairs");
    REQUIRE(pairs.walk() == pairs.sorted());
  }
}

TEST_CASE("Bullet's own walk has the same order") {
  btHashedOverlappingPairCache cache;
  Pairs pairs;
  std::mt19937 random(6);
  for (int n = 0; n < 200; ++n) pairs.add(random() % 40, random() % 40);
  for (int i = 0; i < pairs.array.size(); ++i)
    cache.addOverlappingPair(pairs.array[i].m_pProxy0, pairs.array[i].m_pProxy1);
  REQUIRE(cache.getNumOverlappingPairs() == pairs.array.size());
  Walked walked;
  btDispatcherInfo info;
  info.m_deterministicOverlappingPairs = true;
  cache.processAllOverlappingPairs(&walked, nullptr, info);
  CHECK(walked.ids == pairs.walk());
}

TEST_CASE("A pair that has another's place is not taken for it") {
  Pairs pairs;
  pairs.add(0, 1);
  pairs.add(0, 2);
  REQUIRE(pairs.walk() == pairs.sorted());
  pairs.remove(0);
  CHECK(pairs.walk() == pairs.sorted());
  pairs.remove(0);
  pairs.add(3, 4);
  CHECK(pairs.walk() == pairs.sorted());
}

TEST_CASE("A pair's manifold is looked for until there is one") {
  Pairs pairs;
  Algorithm algorithm;
  pairs.add(0, 1);
  pairs.walk();
  pairs.array[0].m_algorithm = &algorithm;
  pairs.walk();
  pairs.walk();
  CHECK(algorithm.asked == 2);
  algorithm.manifold = std::make_unique<btPersistentManifold>();
  pairs.walk();
  CHECK(algorithm.asked == 3);
  pairs.walk();
  CHECK(algorithm.asked == 3);
  // It may go while the pair stays: it is not read.
  algorithm.manifold.reset();
  CHECK(pairs.walk() == pairs.sorted());
}

}  // namespace
}  // namespace aureole
