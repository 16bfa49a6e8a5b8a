// The three ways in which it is decided which body is hosted where.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace aureole {

/// Chosen per world; all servers of a world run the same one.
enum class MigrationMode : std::uint8_t {
  naive,     ///< On crossing the boundary; bodies of two servers never meet (section 3.1).
  paper,     ///< Aura projection as published: one radius for every body (sections 3.2 to 4.2).
  adaptive,  ///< Auras by what a body can do; what rests is cut at the boundary.
};

/// "naive", "paper", "adaptive".
std::string_view name_of(MigrationMode mode);
std::optional<MigrationMode> migration_mode_from(std::string_view name);

}  // namespace aureole
