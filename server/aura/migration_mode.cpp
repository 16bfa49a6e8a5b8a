// Modes by name, and the policy that each one stands for.
#include "server/aura/migration_mode.h"

#include "server/aura/migration_policy.h"

namespace aureole {

std::string_view name_of(MigrationMode mode) {
  switch (mode) {
    case MigrationMode::naive:
      return "naive";
    case MigrationMode::paper:
      return "paper";
    case MigrationMode::adaptive:
      return "adaptive";
  }
  return "adaptive";
}

std::optional<MigrationMode> migration_mode_from(std::string_view name) {
  for (const auto mode : {MigrationMode::naive, MigrationMode::paper, MigrationMode::adaptive})
    if (name_of(mode) == name) return mode;
  return {};
}

std::unique_ptr<MigrationPolicy> make_policy(MigrationMode mode, const AuraTolerances& tolerances) {
  switch (mode) {
    case MigrationMode::naive:
      return make_naive_policy();
    case MigrationMode::paper:
      return make_paper_policy(tolerances);
    case MigrationMode::adaptive:
      return make_adaptive_policy(tolerances);
  }
  return make_adaptive_policy(tolerances);
}

}  // namespace aureole
