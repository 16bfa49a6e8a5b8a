// Queries through Bullet's broadphase trees.
#include "server/physics/bullet/bullet_queries.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// The trees hold the boxes of the last collision detection; bodies have moved one step since. No
/// body of ours is faster than this many metres a step.
constexpr float moved_since_detection = 1.0f;

struct ObjectVisitor : btBroadphaseAabbCallback {
  explicit ObjectVisitor(std::vector<btBroadphaseProxy*>& into) : found(into) {}
  bool process(const btBroadphaseProxy* proxy) override {
    found.push_back(const_cast<btBroadphaseProxy*>(proxy));
    return true;
  }
  std::vector<btBroadphaseProxy*>& found;
};

std::vector<btBroadphaseProxy*> proxies_in(BulletWorld& world, const btVector3& low,
                                           const btVector3& high) {
  std::vector<btBroadphaseProxy*> found;
  ObjectVisitor visitor(found);
  world.broadphase().aabbTest(low, high, visitor);
  return found;
}

/// Bodies and geometry but one body; planes are met by formula, which is exact however long the
/// ray.
struct RayVisitor : btCollisionWorld::ClosestRayResultCallback {
  using ClosestRayResultCallback::ClosestRayResultCallback;
  bool needsCollision(btBroadphaseProxy* proxy) const override {
    const btCollisionObject* object = object_of(proxy);
    return body_of(object) != ignore &&
           object->getCollisionShape()->getShapeType() != STATIC_PLANE_PROXYTYPE;
  }
  /// Not null where nothing is ignored: static geometry has no body and must be met.
  const void* ignore = this;
};

float squared_distance_to_box(const btVector3& p, const btVector3& low, const btVector3& high) {
  btVector3 nearest = p;
  nearest.setMax(low);
  nearest.setMin(high);
  return (p - nearest).length2();
}

}  // namespace

void for_each_pair(BulletWorld& world, const BulletBody& body,
                   const std::function<void(btCollisionObject&, const btBroadphasePair&)>& visit) {
  btBroadphaseProxy* own = const_cast<btBroadphaseProxy*>(body.rigid.getBroadphaseHandle());
  for (btBroadphaseProxy* proxy : proxies_in(world, own->m_aabbMin, own->m_aabbMax)) {
    if (proxy == own) continue;
    if (const btBroadphasePair* pair = world.pairs().findPair(own, proxy))
      visit(*object_of(proxy), *pair);
  }
}

std::vector<BodyId> bodies_touching(BulletWorld& world, const BulletBody& body) {
  std::vector<BodyId> out;
  btManifoldArray manifolds;
  for_each_pair(world, body, [&](btCollisionObject& other, const btBroadphasePair& pair) {
    const BulletBody* partner = body_of(&other);
    if (partner && has_contact_points(pair, manifolds)) out.push_back(partner->id);
  });
  std::sort(out.begin(), out.end());
  return out;
}

void fetch_touching(const BulletBody& body, FetchStep step) {
  const std::vector<ContactEdge>& edges = body.contact_edges;
  switch (step) {
    case FetchStep::object:
      prefetch(&edges);
      break;
    case FetchStep::list:
      if (!edges.empty()) prefetch(edges.data(), edges.size() * sizeof(ContactEdge));
      break;
    case FetchStep::listed:
      for (const ContactEdge& edge : edges) {
        prefetch_point_count(edge.manifold);
        if (edge.partner) prefetch(&edge.partner->role);
      }
      break;
  }
}

std::size_t find_touching(const BulletBody& body, std::vector<std::uint32_t>& found) {
  found.clear();
  std::size_t on_stand_ins = 0;
  // Each lies somewhere else: they are fetched side by side, not one after another.
  fetch_touching(body, FetchStep::listed);
  for (const auto& [manifold, partner] : body.contact_edges) {
    if (!partner || manifold->getNumContacts() == 0) continue;
    if (partner->role == Role::stand_in)
      ++on_stand_ins;
    else
      found.push_back(partner->slot);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found.size() + on_stand_ins;
}

void append_loads(const BulletBody& stand_in, std::vector<StandInLoad>& loads) {
  const auto first = static_cast<std::ptrdiff_t>(loads.size());
  for (const auto& [manifold, body] : stand_in.contact_edges) {
    if (manifold->getNumContacts() == 0) continue;
    if (!body || !body->rigid.isActive()) continue;
    float sum = 0;
    for (int p = 0; p < manifold->getNumContacts(); ++p)
      sum += manifold->getContactPoint(p).getAppliedImpulse();
    loads.push_back({stand_in.id, body->id, stand_in.prototype, body->prototype, sum});
  }
  // A compound pair has several manifolds. Sums of floats depend on their order: that of the sums
  // themselves is the same however the manifolds stand.
  std::sort(loads.begin() + first, loads.end(), [](const StandInLoad& x, const StandInLoad& y) {
    return std::tie(x.body, x.impulse_ns) < std::tie(y.body, y.impulse_ns);
  });
  auto last = loads.begin() + first;
  for (auto next = last; next != loads.end(); ++next) {
    if (next == last) continue;
    if (last->body == next->body)
      last->impulse_ns += next->impulse_ns;
    else
      *++last = *next;
  }
  if (last != loads.end()) loads.erase(last + 1, loads.end());
}

bool has_support(BulletWorld& world, const BulletBody& body, float min_up) {
  bool supported = false;
  btManifoldArray manifolds;
  for_each_pair(world, body, [&](btCollisionObject&, const btBroadphasePair& pair) {
    if (supported || !has_contact_points(pair, manifolds)) return;
    for (int m = 0; m < manifolds.size(); ++m) {
      // The normal pushes body 0; the other one is pushed the other way.
      const float sign = manifolds[m]->getBody0() == &body.rigid ? 1.f : -1.f;
      for (int i = 0; i < manifolds[m]->getNumContacts(); ++i)
        supported |= sign * manifolds[m]->getContactPoint(i).m_normalWorldOnB.y() > min_up;
    }
  });
  return supported;
}

std::vector<BodyId> bodies_in_sphere(BulletWorld& world, const WorldPosition& centre,
                                     float radius) {
  const btVector3 middle = world.local(centre);
  const float reach = radius + moved_since_detection;
  const btVector3 extent(reach, reach, reach);
  std::vector<BodyId> out;
  for (btBroadphaseProxy* proxy : proxies_in(world, middle - extent, middle + extent)) {
    const BulletBody* body = body_of(object_of(proxy));
    if (!body || body->role == Role::stand_in) continue;
    btVector3 low, high;
    body->rigid.getAabb(low, high);
    if (squared_distance_to_box(middle, low, high) <= radius * radius) out.push_back(body->id);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::optional<RayHit> nearest_hit(BulletWorld& world, const WorldPosition& from,
                                  const WorldPosition& to, const BulletBody* ignore) {
  RayVisitor visitor(world.local(from), world.local(to));
  if (ignore) visitor.ignore = ignore;
  world.dynamics().rayTest(visitor.m_rayFromWorld, visitor.m_rayToWorld, visitor);

  std::optional<RayHit> hit;
  if (visitor.hasHit()) {
    const BulletBody* body = body_of(visitor.m_collisionObject);
    hit.emplace();
    hit->what =
        body ? ContactPartner{body->id} : ContactPartner{static_of(visitor.m_collisionObject)};
    hit->normal = from_bullet(visitor.m_hitNormalWorld);
    hit->fraction = visitor.m_closestHitFraction;
  }
  const auto definitions = world.shapes().statics();
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    if (!std::holds_alternative<PlaneShape>(definitions[i].shape)) continue;
    const double above = from.y - definitions[i].position.y;
    const double below = definitions[i].position.y - to.y;
    if (above < 0 || below < 0 || above + below <= 0) continue;  // does not come down through it
    const auto fraction = static_cast<float>(above / (above + below));
    if (hit && hit->fraction <= fraction) continue;
    hit = RayHit{StaticId{static_cast<StaticId::rep>(i)}, {}, {0, 1, 0}, fraction};
  }
  if (hit)
    hit->point = WorldPosition::from(
        Eigen::Vector3d(from.vector() + double{hit->fraction} * (to.vector() - from.vector())));
  return hit;
}

}  // namespace aureole
