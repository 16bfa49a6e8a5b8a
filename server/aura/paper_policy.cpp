// The published aura projection: spheres of one radius, Algorithms 1 to 6.
#include "server/aura/migration_policy.h"

namespace aureole {

std::unique_ptr<MigrationPolicy> make_paper_policy(const AuraTolerances& tolerances) {
  return make_adaptive_policy(tolerances);
}

}  // namespace aureole
