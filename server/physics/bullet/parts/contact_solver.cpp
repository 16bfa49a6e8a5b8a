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
    if (n + ahead < count) prefetch_manifold(manifolds[n + ahead]);
    convertContact(manifolds[n], info);
  }
}

}  // namespace aureole
