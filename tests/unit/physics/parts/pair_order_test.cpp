// The order in which pairs are walked through, against Bullet's own walk.
#include "server/physics/bullet/parts/pair_order.h"

#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/catch.h"

namespace aureole {
namespace {

using Ids = std::pair<int, int>;

class Walked : public btOverlapCallback {
 public:
  bool processOverlap(btBroadphasePair& pair) override {
    ids.emplace_back(pair.m_pProxy0->m_uniqueId, pair.m_pProxy1->m_uniqueId);
    return false;
  }
  std::vector<Ids> ids;
};

/// Touches nothing; has one manifold, or none.
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

constexpr std::size_t proxies_max = 40;

/// Bullet's pairs, of which the last one takes the place of whichever is taken out.
struct Pairs {
  Pairs() {
    for (std::size_t n = 0; n < proxies_max; ++n) {
      objects.push_back(std::make_unique<btCollisionObject>());
      auto proxy = std::make_unique<btBroadphaseProxy>();
      proxy->m_clientObject = objects.back().get();
      proxy->m_collisionFilterGroup = proxy->m_collisionFilterMask = 1;
      proxy->m_uniqueId = static_cast<int>(n + 1);
      proxies.push_back(std::move(proxy));
    }
  }
  btBroadphaseProxy* proxy(std::size_t n) { return proxies[n].get(); }
  void add(std::size_t a, std::size_t b) {
    if (a != b) cache.addOverlappingPair(proxy(a), proxy(b));
  }
  void remove(std::size_t a, std::size_t b) {
    if (a == b) return;
    if (btBroadphasePair* pair = cache.findPair(proxy(a), proxy(b))) pair->m_algorithm = nullptr;
    cache.removeOverlappingPair(proxy(a), proxy(b), nullptr);
  }
  btBroadphasePair& pair(std::size_t a, std::size_t b) {
    return *cache.findPair(proxy(a), proxy(b));
  }
  std::vector<Ids> walk() {
    Walked walked;
    order.walk(cache.getOverlappingPairArray(), walked);
    return walked.ids;
  }
  std::vector<Ids> walk_of_bullet() {
    Walked walked;
    btDispatcherInfo info;
    info.m_deterministicOverlappingPairs = true;
    cache.processAllOverlappingPairs(&walked, nullptr, info);
    return walked.ids;
  }

  std::vector<std::unique_ptr<btCollisionObject>> objects;
  std::vector<std::unique_ptr<btBroadphaseProxy>> proxies;
  btHashedOverlappingPairCache cache;
  PairOrder order;
};

TEST_CASE("Whoever comes and goes, pairs are walked through in Bullet's order") {
  Pairs pairs;
  CHECK(pairs.walk().empty());
  std::mt19937 random(5);
  for (int step = 0; step < 400; ++step) {
    // Some steps change nothing, some nearly everything; every hundredth begins anew.
    const std::size_t changes = step % 3 == 0 ? 0 : random() % (step % 7 == 0 ? 600 : 4);
    for (std::size_t n = 0; n < changes; ++n) {
      const std::size_t a = random() % proxies_max;
      const std::size_t b = random() % proxies_max;
      if (random() % 2 == 0)
        pairs.remove(a, b);
      else
        pairs.add(a, b);
    }
    if (step % 100 == 99)
      for (std::size_t a = 0; a < proxies_max; ++a)
        for (std::size_t b = 0; b < a; ++b) pairs.remove(a, b);
    INFO("step " << step << ", " << pairs.cache.getNumOverlappingPairs() << " pairs");
    REQUIRE(pairs.walk() == pairs.walk_of_bullet());
  }
}

TEST_CASE("A pair that has another's place is not taken for it") {
  Pairs pairs;
  pairs.add(0, 1);
  pairs.add(0, 2);
  pairs.add(1, 2);
  REQUIRE(pairs.walk() == pairs.walk_of_bullet());
  pairs.remove(0, 1);
  CHECK(pairs.walk() == pairs.walk_of_bullet());
  pairs.remove(0, 2);
  pairs.add(3, 4);
  CHECK(pairs.walk() == pairs.walk_of_bullet());
}

TEST_CASE("Ids that Bullet's counter gets to after two thousand million come last") {
  Pairs pairs;
  pairs.proxy(0)->m_uniqueId = std::numeric_limits<int>::min();
  pairs.proxy(1)->m_uniqueId = -1;
  pairs.proxy(2)->m_uniqueId = std::numeric_limits<int>::max();
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < a; ++b) pairs.add(a, b);
  CHECK(pairs.walk() == pairs.walk_of_bullet());
}

TEST_CASE("A pair's manifold is looked for until there is one") {
  Pairs pairs;
  Algorithm algorithm;
  pairs.add(0, 1);
  pairs.walk();
  pairs.pair(0, 1).m_algorithm = &algorithm;
  pairs.walk();
  pairs.walk();
  CHECK(algorithm.asked == 2);
  algorithm.manifold = std::make_unique<btPersistentManifold>();
  pairs.walk();
  CHECK(algorithm.asked == 3);
  pairs.walk();
  CHECK(algorithm.asked == 3);
  pairs.remove(0, 1);
}

// With AddressSanitizer this says that a manifold that has gone is not read.
TEST_CASE("Manifolds may go while their pairs stay") {
  Pairs pairs;
  std::vector<Algorithm> algorithms(proxies_max - 1);
  for (std::size_t n = 0; n < algorithms.size(); ++n) {
    algorithms[n].manifold = std::make_unique<btPersistentManifold>();
    pairs.add(n, n + 1);
    pairs.pair(n, n + 1).m_algorithm = &algorithms[n];
  }
  pairs.walk();
  for (std::size_t n = 0; n < algorithms.size(); n += 2) algorithms[n].manifold.reset();
  CHECK(pairs.walk() == pairs.walk_of_bullet());
  for (std::size_t n = 0; n < algorithms.size(); ++n) pairs.remove(n, n + 1);
}

}  // namespace
}  // namespace aureole
