// One convention for both ways: in plain data a is the body with the smaller id, whichever body
// Bullet calls A. Exchanging the two is exact: points change places, directions change sign (a
// lateral impulse pushes A along its direction), impulses stay.
#include "server/physics/bullet/bullet_contacts.h"

#include <algorithm>
#include <tuple>

#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/bullet_queries.h"
#include "server/physics/bullet/parts/pair_key.h"

namespace aureole {
namespace {

ContactPoint exchanged(const ContactPoint& p) {
  ContactPoint q = p;
  std::swap(q.local_on_a, q.local_on_b);
  std::swap(q.child_a, q.child_b);
  q.normal_on_b = -p.normal_on_b;
  q.lateral_1 = -p.lateral_1;
  q.lateral_2 = -p.lateral_2;
  return q;
}

/// As Bullet has it: a is the manifold's body 0.
ContactPoint plain_point(const btManifoldPoint& p) {
  ContactPoint out;
  out.local_on_a = from_bullet(p.m_localPointA);
  out.local_on_b = from_bullet(p.m_localPointB);
  out.normal_on_b = from_bullet(p.m_normalWorldOnB);
  out.distance = p.m_distance1;
  out.impulse = p.m_appliedImpulse;
  out.impulse_lateral_1 = p.m_appliedImpulseLateral1;
  out.impulse_lateral_2 = p.m_appliedImpulseLateral2;
  out.lateral_1 = from_bullet(p.m_lateralFrictionDir1);
  out.lateral_2 = from_bullet(p.m_lateralFrictionDir2);
  out.age_steps = p.m_lifeTime;
  out.flags = p.m_contactPointFlags;
  out.child_a = static_cast<std::int16_t>(p.m_index0);
  out.child_b = static_cast<std::int16_t>(p.m_index1);
  return out;
}

btManifoldPoint bullet_point(const ContactPoint& p, const btPersistentManifold& manifold) {
  const btCollisionObject* a = manifold.getBody0();
  const btCollisionObject* b = manifold.getBody1();
  btManifoldPoint out(to_bullet(p.local_on_a), to_bullet(p.local_on_b), to_bullet(p.normal_on_b),
                      p.distance);
  out.m_positionWorldOnA = a->getWorldTransform() * out.m_localPointA;
  out.m_positionWorldOnB = b->getWorldTransform() * out.m_localPointB;
  out.m_combinedFriction = btManifoldResult::calculateCombinedFriction(a, b);
  out.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution(a, b);
  out.m_combinedRollingFriction = btManifoldResult::calculateCombinedRollingFriction(a, b);
  out.m_combinedSpinningFriction = btManifoldResult::calculateCombinedSpinningFriction(a, b);
  out.m_appliedImpulse = p.impulse;
  out.m_appliedImpulseLateral1 = p.impulse_lateral_1;
  out.m_appliedImpulseLateral2 = p.impulse_lateral_2;
  out.m_lateralFrictionDir1 = to_bullet(p.lateral_1);
  out.m_lateralFrictionDir2 = to_bullet(p.lateral_2);
  out.m_lifeTime = p.age_steps;
  // The other flags would read fields that are not carried; none of our bodies sets them.
  out.m_contactPointFlags = p.flags & BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED;
  out.m_index0 = p.child_a;
  out.m_index1 = p.child_b;
  return out;
}

bool same_children(const btPersistentManifold& manifold, const ContactPoint& p) {
  const btManifoldPoint& first = manifold.getContactPoint(0);
  return first.m_index0 == p.child_a && first.m_index1 == p.child_b;
}

/// The manifold that `points` (in Bullet's order of bodies) belong to. Compound pairs are matched
/// by their children; a manifold that found no point of its own takes the first that are left.
btPersistentManifold* choose(btManifoldArray& manifolds, const std::vector<ContactPoint>& points) {
  if (manifolds.size() == 1) return manifolds[0];
  for (int i = 0; i < manifolds.size(); ++i)
    if (manifolds[i]->getNumContacts() > 0 && same_children(*manifolds[i], points.front()))
      return manifolds[i];
  for (int i = 0; i < manifolds.size(); ++i)
    if (manifolds[i]->getNumContacts() == 0) return manifolds[i];
  return nullptr;
}

void replace_points(btManifoldArray& manifolds, const CarriedContact& carried) {
  if (manifolds.size() == 0 || carried.manifold->points.empty()) return;
  const bool swapped = manifolds[0]->getBody0() != carried.a;
  std::vector<ContactPoint> points = carried.manifold->points;
  if (swapped) std::transform(points.begin(), points.end(), points.begin(), exchanged);
  btPersistentManifold* manifold = choose(manifolds, points);
  if (!manifold) return;
  manifold->clearManifold();
  const std::size_t count = std::min<std::size_t>(points.size(), MANIFOLD_CACHE_SIZE);
  for (std::size_t i = 0; i < count; ++i)
    manifold->addManifoldPoint(bullet_point(points[i], *manifold));
}

ContactManifold plain_manifold(const btPersistentManifold& manifold, const BulletBody& a,
                               ContactPartner b, int ordinal) {
  ContactManifold out{a.id, b, static_cast<std::uint16_t>(ordinal), {}};
  const bool swapped = manifold.getBody0() != &a.rigid;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const ContactPoint point = plain_point(manifold.getContactPoint(i));
    out.points.push_back(swapped ? exchanged(point) : point);
  }
  return out;
}

void look_at(BulletWorld& world, btBroadphasePair& pair) {
  world.dispatcher().admit_sleeping(true);
  btCollisionDispatcher::defaultNearCallback(pair, world.dispatcher(),
                                             world.dynamics().getDispatchInfo());
  world.dispatcher().admit_sleeping(false);
}

/// True if a pair met from `body`'s side is to be taken from the other side, or not at all.
bool is_left_out(const BulletBody& body, const BulletBody& other, Partners partners) {
  if (!other.marked) return partners == Partners::within;
  return other.id < body.id;  // both are of the group: met once from either side
}

}  // namespace

std::vector<ContactManifold> extract_contacts(BulletWorld& world,
                                              std::span<BulletBody* const> group, Partners partners,
                                              std::vector<BodyId>* beside_others) {
  if (beside_others) beside_others->clear();
  for (BulletBody* body : group) body->marked = true;
  std::vector<ContactManifold> out;
  btManifoldArray manifolds;
  for (BulletBody* body : group) {
    bool beside = false;
    for_each_pair(world, *body, [&](btCollisionObject& object, const btBroadphasePair& pair) {
      const BulletBody* other = body_of(&object);
      beside |= other && other->role == Role::body && !other->marked;
      if (other && is_left_out(*body, *other, partners)) return;
      if (!has_contact_points(pair, manifolds)) return;
      const bool body_first = !other || body->id < other->id;
      const BulletBody& a = body_first ? *body : *other;
      const ContactPartner b = !other       ? ContactPartner{static_of(&object)}
                               : body_first ? ContactPartner{other->id}
                                            : ContactPartner{body->id};
      for (int i = 0; i < manifolds.size(); ++i)
        if (manifolds[i]->getNumContacts() > 0)
          out.push_back(plain_manifold(*manifolds[i], a, b, i));
    });
    if (beside && beside_others) beside_others->push_back(body->id);
  }
  for (BulletBody* body : group) body->marked = false;
  std::sort(out.begin(), out.end(), [](const ContactManifold& x, const ContactManifold& y) {
    return std::tie(x.a, x.b, x.ordinal) < std::tie(y.a, y.b, y.ordinal);
  });
  return out;
}

void install_contacts(BulletWorld& world, std::vector<CarriedContact> carried) {
  struct Job {
    PairKey key;
    CarriedContact contact;
  };
  std::vector<Job> jobs;
  for (const CarriedContact& c : carried) {
    if (!c.a || !c.b || c.a == c.b) continue;
    jobs.push_back({{*c.a->getBroadphaseHandle(), *c.b->getBroadphaseHandle()}, c});
  }
  // Manifolds that are made early then stand as they would, had everybody always been here.
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const Job& x, const Job& y) { return x.key < y.key; });

  btManifoldArray manifolds;
  for (std::size_t i = 0; i < jobs.size();) {
    const CarriedContact& first = jobs[i].contact;
    std::size_t end = i;
    while (end < jobs.size() && jobs[end].key == jobs[i].key) ++end;
    btBroadphasePair* pair =
        world.pairs().findPair(first.a->getBroadphaseHandle(), first.b->getBroadphaseHandle());
    if (pair) {
      look_at(world, *pair);
      manifolds.resize(0);
      if (pair->m_algorithm) pair->m_algorithm->getAllContactManifolds(manifolds);
      for (std::size_t j = i; j < end; ++j) replace_points(manifolds, jobs[j].contact);
    }
    i = end;
  }
}

void detect_contacts(BulletWorld& world, std::span<BulletBody* const> group, int pairs_before) {
  std::vector<std::pair<PairKey, btBroadphasePair*>> pairs;
  const auto add = [&](const btBroadphasePair& pair) {
    pairs.emplace_back(PairKey(*pair.m_pProxy0, *pair.m_pProxy1),
                       const_cast<btBroadphasePair*>(&pair));
  };
  const btBroadphasePairArray& all = world.pairs().getOverlappingPairArray();
  for (int i = pairs_before; i < all.size(); ++i) add(all[i]);
  for (BulletBody* body : group)
    for_each_pair(world, *body,
                  [&](btCollisionObject&, const btBroadphasePair& pair) { add(pair); });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [key, pair] : pairs) look_at(world, *pair);
}

}  // namespace aureole
