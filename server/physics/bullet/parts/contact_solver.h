// Rows of contacts, with memory asked for ahead.
#pragma once

#include <btBulletDynamicsCommon.h>

namespace aureole {

/// Bullet's solver, which asks for contacts ahead of making rows of them, and for bodies ahead of
/// taking them in.
class ContactSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count,
                       const btContactSolverInfo& info) override;
  void convertBodies(btCollisionObject** bodies, int count,
                     const btContactSolverInfo& info) override;
};

}  // namespace aureole
