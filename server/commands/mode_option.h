// The option --mode, the same for every command that reads a world.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "server/aura/migration_mode.h"

namespace aureole {

/// `mode` stays empty unless the option is given, and migration_mode_from() then makes nothing of
/// it: the world file's own mode counts.
inline void add_mode_option(CLI::App& command, std::string& mode) {
  command
      .add_option(
          "--mode", mode,
          "How it is decided which body is hosted where: naive, paper or adaptive. Without\n"
          "it the world file's own mode counts. All servers of a world run the same one")
      ->check(CLI::IsMember({"naive", "paper", "adaptive"}));
}

}  // namespace aureole
