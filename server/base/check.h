// Assertions that stay on in release: a programmer's mistake ends the process with a sentence.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace aureole::detail {
[[noreturn]] inline void check_failed(const char* what, const char* why, const char* file,
                                      int line) {
  std::fprintf(stderr, "aureole: broken invariant: %s (%s) at %s:%d\n", why, what, file, line);
  std::abort();
}
}  // namespace aureole::detail

/// AUREOLE_CHECK(condition, "what holds here, as a sentence"). Never used on input from outside.
#define AUREOLE_CHECK(condition, why) \
  ((condition) ? void(0) : ::aureole::detail::check_failed(#condition, why, __FILE__, __LINE__))
