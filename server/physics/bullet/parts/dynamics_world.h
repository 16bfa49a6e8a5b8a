// What a step does to bodies one by one.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <vector>

namespace aureole {

/// Bullet's world, in which a step looks at what is awake.
///
/// Bullet goes through all bodies, or all objects, some ten times in a step, and most of them
/// sleep: each time the line of memory that says so has to be fetched. Here a step finds those
/// awake once when it begins and once more when islands have woken and laid down whom they may; and
/// memory is asked for ahead of each walk. What comes of a step is the same, bit for bit.
///
/// Requires: nobody has a motion state or a threshold for continuous collisions; forces are applied
/// to what is awake; who is kinematic is in kinematic(), and static geometry asleep.
class DynamicsWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  /// Bullet searches this list from its start for each removal. Ours is in the order of addresses:
  /// what a step does to each of them does not depend on the others.
  btAlignedObjectArray<btRigidBody*>& moving() { return m_nonStaticRigidBodies; }
  /// What moves along its own velocity; in no order that means anything.
  std::vector<btRigidBody*>& kinematic() { return kinematic_; }

  // Parts of a step; what is empty would do nothing for bodies like ours.
  void saveKinematicState(btScalar dt_s) override;
  /// The first that asks who is awake: finds them.
  void applyGravity() override;
  void updateAabbs() override;
  void synchronizeMotionStates() override {}
  void clearForces() override;

 protected:
  /// Bullet damps sleepers too, and foretells where they will be. They stand still, and nobody
  /// reads it before they wake, and the next step foretells it.
  void predictUnconstraintMotion(btScalar dt_s) override;
  void createPredictiveContacts(btScalar) override {}
  void integrateTransforms(btScalar dt_s) override;

 private:
  void find_awake(std::vector<btRigidBody*>& awake);

  std::vector<btRigidBody*> kinematic_;
  bool steps_ = false;  ///< From applyGravity() to clearForces(); only then are these two valid:
  std::vector<btRigidBody*> awake_;      ///< Of `moving()`, when the step began.
  std::vector<btRigidBody*> awake_now_;  ///< The same, when its contacts are solved.
  std::vector<std::uint64_t> renewed_;   ///< Only used within updateAabbs(), like …
  std::vector<int> order_;               ///< … this.
};

}  // namespace aureole
