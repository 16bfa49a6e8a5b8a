// The option --secret, the same for every server of a world.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "server/net/links/secret.h"

namespace aureole {

/// `file` stays empty unless it is given.
inline void add_secret_option(CLI::App& command, std::string& file) {
  command
      .add_option("--secret", file,
                  "File with a text of 16 characters or more, the same for every server of the\n"
                  "world: whoever does not know it cannot pass for one of them")
      ->envname("AUREOLE_SECRET");
}

inline Result<std::optional<Secret>> secret_from(const std::string& file) {
  if (file.empty()) return std::optional<Secret>{};
  auto secret = Secret::read(file);
  if (!secret) return Error{"--secret: " + secret.error().message};
  return std::optional<Secret>{std::move(*secret)};
}

}  // namespace aureole
