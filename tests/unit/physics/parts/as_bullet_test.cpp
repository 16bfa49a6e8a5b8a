// Our parts of a Bullet world against Bullet's own: what falls falls the same way, bit for bit.
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "server/physics/bullet/parts/contact_solver.h"
#include "server/physics/bullet/parts/dispatcher.h"
#include "server/physics/bullet/parts/dynamics_world.h"
#include "server/physics/bullet/parts/pair_cache.h"
#include "tests/support/catch.h"

namespace aureole {
namespace {

/// Balls, boxes, capsules and compounds of a box on a ball over level ground, in a world of these
/// parts.
template <class Collisions, class Cache, class Solver, class World>
class Heap {
 public:
  Heap()
      : dispatcher_(&configuration_),
        broadphase_(&cache_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setForceUpdateAllAabbs(false);
    world_.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world_.getSolverInfo().m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
    world_.setGravity({0, -9.81f, 0});
    compound_.addChildShape(btTransform(btQuaternion::getIdentity(), {0, 0.5f, 0}), &box_);
    compound_.addChildShape(btTransform(btQuaternion::getIdentity(), {0, -0.5f, 0}), &ball_);
    ground_.setCollisionShape(&plane_);
    // As our worlds have it; see BulletWorld::add_statics().
    ground_.forceActivationState(ISLAND_SLEEPING);
    world_.addCollisionObject(&ground_);
    paddle_.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    paddle_.forceActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&paddle_);
    if constexpr (requires { world_.kinematic(); }) {
      world_.kinematic().push_back(&paddle_);
      world_.moving().remove(&paddle_);
    }
    std::mt19937 random(11);
    std::uniform_real_distribution<float> aside(-3, 3);
    for (int n = 0; n < 160; ++n) {
      btCollisionShape* const shapes[] = {&ball_, &box_, &capsule_, &compound_};
      btCollisionShape* shape = shapes[n % 4];
      btVector3 inertia;
      shape->calculateLocalInertia(1, inertia);
      bodies_.push_back(std::make_unique<btRigidBody>(1.f, nullptr, shape, inertia));
      const float x = aside(random);
      const float z = aside(random);
      const float yaw = aside(random);
      const float pitch = aside(random);
      const btQuaternion turned(yaw, pitch, aside(random));
      bodies_.back()->setWorldTransform(
          btTransform(turned, {x, 1 + 0.1f * static_cast<float>(n), z}));
      bodies_.back()->setDamping(0.1f, 0.3f);
      bodies_.back()->setRollingFriction(0.05f);
      world_.addRigidBody(bodies_.back().get());
    }
  }
  ~Heap() {
    // Ours takes no pair out with its proxies.
    while (cache_.getNumOverlappingPairs() > 0) {
      const btBroadphasePair& pair = cache_.getOverlappingPairArray()[0];
      cache_.removeOverlappingPair(pair.m_pProxy0, pair.m_pProxy1, &dispatcher_);
    }
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    world_.removeRigidBody(&paddle_);
    world_.removeCollisionObject(&ground_);
  }
  Heap(const Heap&) = delete;
  Heap& operator=(const Heap&) = delete;

  /// The paddle goes through the heap once, and then away.
  void step() {
    paddle_at_m_ += 0.02f;
    paddle_.setWorldTransform(btTransform(btQuaternion::getIdentity(), {paddle_at_m_, 0.4f, 0}));
    world_.stepSimulation(0.016f, 0);
  }
  /// Throws a ball at the last body that sleeps.
  void strike() {
    const auto target = std::find_if(bodies_.rbegin(), bodies_.rend(),
                                     [](const auto& body) { return !body->isActive(); });
    if (target == bodies_.rend()) return;
    btRigidBody& ball = *bodies_.front();
    const btVector3 to = (*target)->getWorldTransform().getOrigin();
    ball.setWorldTransform(btTransform(btQuaternion::getIdentity(), to + btVector3(0, 1.5f, 0)));
    ball.setLinearVelocity({0, -15, 0});
    ball.activate(true);
    // A step of no time takes forces off.
    ball.applyCentralForce({50, 0, 0});
    world_.stepSimulation(0, 0);
  }
  int contacts() { return dispatcher_.getNumManifolds(); }
  int asleep() const {
    int count = 0;
    for (const auto& body : bodies_) count += body->isActive() ? 0 : 1;
    return count;
  }
  /// Where bodies are and how they move, as bytes.
  std::vector<float> state() const {
    std::vector<float> all;
    const auto add = [&](const btVector3& v) { all.insert(all.end(), {v.x(), v.y(), v.z()}); };
    for (const auto& body : bodies_) {
      add(body->getWorldTransform().getOrigin());
      for (int row = 0; row < 3; ++row) add(body->getWorldTransform().getBasis()[row]);
      add(body->getLinearVelocity());
      add(body->getAngularVelocity());
    }
    return all;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  Collisions dispatcher_;
  Cache cache_;
  btDbvtBroadphase broadphase_;
  Solver solver_;
  World world_;
  btSphereShape ball_{0.3f};
  btBoxShape box_{{0.5f, 0.15f, 0.4f}};
  btCapsuleShape capsule_{0.2f, 0.7f};
  btCompoundShape compound_;
  btStaticPlaneShape plane_{{0, 1, 0}, 0};
  btCollisionObject ground_;
  btBoxShape paddle_shape_{{0.1f, 0.3f, 1}};
  btRigidBody paddle_{btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &paddle_shape_)};
  float paddle_at_m_ = -6;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST_CASE("What falls onto a heap falls as in Bullet's own world") {
  Heap<Dispatcher, PairCache, ContactSolver, DynamicsWorld> ours;
  Heap<btCollisionDispatcher, btHashedOverlappingPairCache, btSequentialImpulseConstraintSolver,
       btDiscreteDynamicsWorld>
      bullets;
  int most_contacts = 0;
  for (int step = 0; step < 1400; ++step) {
    ours.step();
    bullets.step();
    most_contacts = std::max(most_contacts, ours.contacts());
    INFO("step " << step);
    REQUIRE(same_bits(ours.state(), bullets.state()));
  }
  CHECK(most_contacts > 200);
  CHECK(ours.asleep() == bullets.asleep());
  CHECK(ours.asleep() > 20);  // Sleepers are neither damped nor foretold here.
  // Who is woken by a blow moves in that very step.
  for (int throws = 0; throws < 8; ++throws) {
    ours.strike();
    bullets.strike();
    for (int step = 0; step < 20; ++step) {
      ours.step();
      bullets.step();
      INFO("throw " << throws << ", step " << step);
      REQUIRE(same_bits(ours.state(), bullets.state()));
    }
  }
}

}  // namespace
}  // namespace aureole
