// Bullet's loop over contacts, with memory asked for ahead.
#include "server/physics/bullet/parts/contact_solver.h"

#include "server/physics/bullet/parts/bullet_prefetch.h"

namespace aureole {
namespace {

/// How many contacts lie between asking for one and reading it.
constexpr int ahead = 4;

}  // namespace

void ContactSolver::convertContacts(btPersistentManifold** manifolds, int count,
                                    const btContactSolverInfo& info) {
  for (int n = 0; n < count; ++n) {
    if (n + 2 * ahead < count) prefetch_point_count(manifolds[n + 2 * ahead]);
    if (n + ahead < count) prefetch_points(*manifolds[n + ahead]);
    convertContact(manifolds[n], info);
  }
}

/// All of an island's at once: Bullet goes through them in one walk.
void ContactSolver::convertBodies(btCollisionObject** bodies, int count,
                                  const btContactSolverInfo& info) {
  for (int n = 0; n < count; ++n) prefetch(bodies[n], sizeof(btRigidBody));
  btSequentialImpulseConstraintSolver::convertBodies(bodies, count, info);
}

}  // namespace aureole
