// Setting up, filling, emptying and stepping the Bullet world.
#include "server/physics/bullet/bullet_world.h"

#include <algorithm>

#include "server/base/check.h"
#include "server/physics/bullet/bullet_conversions.h"
#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

// Bullet builds its own copies of these switches into the library: ours must be the same.
static_assert(sizeof(btScalar) == sizeof(float), "Bullet's single precision build is used");

/// Pools for contacts and algorithms. Measured: 65536 of each is worth having in a full world; a
/// pool that runs out falls back to malloc. Touching a pool's pages costs a small world its time.
btDefaultCollisionConstructionInfo pools_for(std::size_t expected_bodies) {
  btDefaultCollisionConstructionInfo info;
  const int elements = static_cast<int>(std::clamp<std::size_t>(expected_bodies * 8, 256, 65536));
  info.m_defaultMaxPersistentManifoldPoolSize = elements;
  info.m_defaultMaxCollisionAlgorithmPoolSize = elements;
  return info;
}

/// The dispatcher copies what the configuration hands out, therefore the configuration is complete
/// before anyone else sees it. Three more support points a step let a box stand on the ground at
/// once.
btDefaultCollisionConfiguration* with_plane_contacts(btDefaultCollisionConfiguration& config) {
  config.setPlaneConvexMultipointIterations(3, 3);
  return &config;
}

int to_bullet(Activation activation) {
  switch (activation) {
    case Activation::awake:
      return ACTIVE_TAG;
    case Activation::wants_sleep:
      return WANTS_DEACTIVATION;
    case Activation::asleep:
      return ISLAND_SLEEPING;
  }
  return ACTIVE_TAG;
}

Activation from_bullet(int state) {
  if (state == ISLAND_SLEEPING || state == DISABLE_SIMULATION) return Activation::asleep;
  return state == WANTS_DEACTIVATION ? Activation::wants_sleep : Activation::awake;
}

}  // namespace

BulletWorld::BulletWorld(const PhysicsSettings& settings, ShapeLibrary& shapes,
                         std::size_t expected_bodies)
    : settings_(settings),
      shapes_(shapes),
      configuration_(pools_for(expected_bodies)),
      dispatcher_(with_plane_contacts(configuration_)),
      broadphase_(&pairs_),
      world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
  AUREOLE_CHECK(settings.solver_iterations >= 1 && settings.solver_iterations <= 50,
                "the solver runs 1 to 50 iterations");
  AUREOLE_CHECK(settings.sleep_after_s > 0, "bodies may fall asleep");
  world_.setGravity(aureole::to_bullet(settings.gravity));
  world_.setForceUpdateAllAabbs(false);
  world_.getDispatchInfo().m_deterministicOverlappingPairs = true;
  world_.getSolverInfo().m_numIterations = settings.solver_iterations;
  world_.getSolverInfo().m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
  world_.setInternalTickCallback(&BulletWorld::before_solving, this, true);
  add_statics();
}

BulletWorld::~BulletWorld() {
  for (const auto& object : statics_) world_.btCollisionWorld::removeCollisionObject(object.get());
}

btVector3 BulletWorld::local(const WorldPosition& p) const {
  return aureole::to_bullet(p.relative_to(settings_.origin));
}

WorldPosition BulletWorld::global(const btVector3& p) const {
  return {settings_.origin.x + double{p.x()}, settings_.origin.y + double{p.y()},
          settings_.origin.z + double{p.z()}};
}

void BulletWorld::add_statics() {
  const auto definitions = shapes_.statics();
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    const StaticDefinition& definition = definitions[i];
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(shapes_.fixed(StaticId{static_cast<StaticId::rep>(i)}));
    const bool plane = std::holds_alternative<PlaneShape>(definition.shape);
    object->setWorldTransform(btTransform(
        plane ? btQuaternion::getIdentity() : aureole::to_bullet(definition.orientation),
        local(definition.position)));
    object->setFriction(definition.friction);
    object->setRestitution(definition.restitution);
    object->setUserIndex(static_cast<int>(i));
    // Geometry counts as asleep, or every sleeping body on it would be looked at in every step.
    object->forceActivationState(ISLAND_SLEEPING);
    insert_object(*object, Mobility::fixed);
    statics_.push_back(std::move(object));
  }
}

std::unique_ptr<BulletBody> BulletWorld::make_body(const NewBody& body, Role role) {
  const bool immovable = role != Role::body;
  const ShapeLibrary::Built& built = shapes_.prototype(body.prototype);
  const BodyDefinition& definition = shapes_.prototypes()[body.prototype.value];
  btRigidBody::btRigidBodyConstructionInfo info(immovable ? 0.f : definition.mass_kg, nullptr,
                                                built.shape,
                                                immovable ? btVector3(0, 0, 0) : built.inertia);
  info.m_friction = definition.friction;
  info.m_restitution = definition.restitution;
  info.m_linearDamping = definition.linear_damping;
  info.m_angularDamping = definition.angular_damping;
  info.m_linearSleepingThreshold = settings_.sleep_linear_speed;
  info.m_angularSleepingThreshold = settings_.sleep_angular_speed;

  auto made = std::make_unique<BulletBody>(body.id, body.prototype, info);
  made->role = role;
  made->upright = definition.upright;
  made->rigid.setUserPointer(made.get());
  if (definition.upright) made->rigid.setAngularFactor(0.f);
  if (role == Role::obstacle) {
    // Without mass Bullet takes it for static; kinematic, it keeps a velocity in the solver's eyes.
    made->rigid.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  } else if (role == Role::body) {
    made->rigid.setGravity(aureole::to_bullet(settings_.gravity));
  }
  put_state(*made, body.state);
  return made;
}

void BulletWorld::put_state(BulletBody& body, const BodyState& state) const {
  AUREOLE_CHECK(is_sane(state), "a state is checked before it reaches Bullet");
  btRigidBody& rigid = body.rigid;
  const btTransform pose(aureole::to_bullet(state.orientation), local(state.position));
  const bool stands = body.role == Role::stand_in;
  const btVector3 none(0, 0, 0);
  const btVector3 linear = stands ? none : aureole::to_bullet(state.linear_velocity);
  const btVector3 angular =
      stands || body.upright ? none : aureole::to_bullet(state.angular_velocity);
  body.orientation = state.orientation;
  body.obstacle_linear = aureole::from_bullet(linear);
  body.obstacle_angular = aureole::from_bullet(angular);
  rigid.setLinearVelocity(linear);
  rigid.setAngularVelocity(angular);
  // Also sets the interpolation pose and velocities, and turns the inertia tensor.
  rigid.setWorldTransform(pose);
  rigid.setCenterOfMassTransform(pose);
  rigid.forceActivationState(stands ? ISLAND_SLEEPING : to_bullet(state.activation));
  if (body.role == Role::obstacle) {
    // An awake obstacle keeps its neighbours awake: only one that is really moving may.
    const bool moves = state.linear_velocity.norm() > settings_.sleep_linear_speed ||
                       body.obstacle_angular.norm() > settings_.sleep_angular_speed;
    rigid.forceActivationState(moves && state.activation != Activation::asleep ? ACTIVE_TAG
                                                                               : ISLAND_SLEEPING);
  }
  rigid.setDeactivationTime(stands ? 0 : state.deactivation_time_s);
}

BodyState BulletWorld::state_of(const BulletBody& body) const {
  BodyState state;
  read(body, state);
  return state;
}

void BulletWorld::read(const BulletBody& body, BodyState& state) const {
  state.position = global(body.rigid.getWorldTransform().getOrigin());
  state.orientation = body.orientation;
  if (body.immovable()) {
    state.linear_velocity = body.obstacle_linear;
    state.angular_velocity = body.obstacle_angular;
  } else {
    state.linear_velocity = aureole::from_bullet(body.rigid.getLinearVelocity());
    state.angular_velocity = aureole::from_bullet(body.rigid.getAngularVelocity());
  }
  state.activation = from_bullet(body.rigid.getActivationState());
  state.deactivation_time_s = body.rigid.getDeactivationTime();
}

void BulletWorld::before_solving(btDynamicsWorld* world, btScalar) {
  // Bullet guesses a kinematic body's velocity from two poses, and loses bits: say what it is.
  auto* self = static_cast<BulletWorld*>(world->getWorldUserInfo());
  for (btRigidBody* rigid : self->world_.kinematic()) {
    const BulletBody& body = *body_of(rigid);
    rigid->setLinearVelocity(aureole::to_bullet(body.obstacle_linear));
    rigid->setAngularVelocity(aureole::to_bullet(body.obstacle_angular));
  }
}

void BulletWorld::drive_obstacles(float dt_s) {
  for (btRigidBody* rigid : world_.kinematic()) {
    BulletBody* const body = body_of(rigid);
    if (body->obstacle_linear.isZero(0) && body->obstacle_angular.isZero(0)) continue;
    btTransform next;
    btTransformUtil::integrateTransform(body->rigid.getWorldTransform(),
                                        aureole::to_bullet(body->obstacle_linear),
                                        aureole::to_bullet(body->obstacle_angular), dt_s, next);
    body->orientation = aureole::from_bullet(next.getRotation());
    next.setRotation(aureole::to_bullet(body->orientation));
    body->rigid.setWorldTransform(next);
    body->rigid.setInterpolationWorldTransform(next);
    world_.updateSingleAabb(&body->rigid);
  }
}

namespace {

/// In the order of their ids bodies that have come from elsewhere lie all over memory: so far ahead
/// each one that is awake is asked for, …
constexpr std::size_t fetched_ahead = 6;
/// … and whether it is.
constexpr std::size_t found_ahead = 16;

/// Its pose, and how fast it is.
void fetch(const btRigidBody& body) {
  prefetch(&body.getWorldTransform(), sizeof(btTransform));
  prefetch(&body.getLinearVelocity());
}

}  // namespace

void AwakeBodies::note(const BulletWorld& world, const BulletBody& body) {
  // Written where it is to be: what has just been written in parts cannot be copied at once.
  NewBody& noted = bodies.emplace_back();
  noted.id = body.id;
  noted.prototype = body.prototype;
  world.read(body, noted.state);
  objects.push_back(&body);
}

void BulletWorld::step(float dt_s, std::span<BulletBody* const> all, AwakeBodies& awake) {
  gDeactivationTime = settings_.sleep_after_s;  // shared by all worlds of the process
  // No sub-steps and no motion states: the pose after the call is the pose of this step exactly.
  world_.stepSimulation(dt_s, 0);
  drive_obstacles(dt_s);
  // A basis is carried as a quaternion and made of it again elsewhere, with other last bits. Going
  // through the quaternion here too makes a body that has moved to another world the same body.
  awake.clear();
  for (std::size_t n = 0; n < all.size(); ++n) {
    BulletBody* body = all[n];
    if (n + found_ahead < all.size()) prefetch_activation(&all[n + found_ahead]->rigid);
    if (const std::size_t m = n + fetched_ahead; m < all.size() && all[m]->rigid.isActive())
      fetch(all[m]->rigid);
    if (!body->rigid.isActive()) continue;
    if (body->immovable()) {
      awake.note(*this, *body);
      continue;
    }
    const btTransform& pose = body->rigid.getWorldTransform();
    const btQuaternion rotation = pose.getRotation();
    body->orientation = aureole::from_bullet(rotation);
    body->rigid.setCenterOfMassTransform(btTransform(rotation, pose.getOrigin()));
    awake.note(*this, *body);
  }
}

}  // namespace aureole
