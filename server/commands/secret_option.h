// The option --secret, the same for every server of a world.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <optional>
#include <string>

#include "server/net/links/secret.h"

namespace aureole {

class SecretOption {
 public:
  void add_to(CLI::App& command) {
    option_ = command
                  .add_option("--secret", file_,
                              "File with a random text of 16 characters or more, the same for "
                              "every\nserver of the world: whoever does not know it cannot pass "
                              "for one of them")
                  ->envname(variable);
  }

  /// Nothing if it was not given. One that names nothing was given by mistake, and is an Error.
  Result<std::optional<Secret>> read() const {
    const bool is_given = option_->count() > 0 || std::getenv(variable) != nullptr;
    if (!is_given) return std::optional<Secret>{};
    if (file_.empty())
      return Error::format("--secret (or {}): names no file; leave it out for none", variable);
    auto secret = Secret::read(file_);
    if (!secret) return Error{"--secret: " + secret.error().message};
    return std::optional<Secret>{std::move(*secret)};
  }

 private:
  static constexpr const char* variable = "AUREOLE_SECRET";
  std::string file_;
  const CLI::Option* option_ = nullptr;
};

}  // namespace aureole
