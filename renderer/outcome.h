// How this room reports what went wrong: values for bad input and machines, checks for programmers.
// It repeats two small things of the servers' vocabulary because the renderer knows no server code.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <variant>

namespace aureole::render {

/// One sentence: what failed and what may help.
struct Failure {
  std::string message;
};

/// Either a value or a Failure. `if (!o) return o.failure();`
template <class T>
class [[nodiscard]] Outcome {
 public:
  Outcome(T value) : content_(std::move(value)) {}            // NOLINT(google-explicit-constructor)
  Outcome(Failure failure) : content_(std::move(failure)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() & { return std::get<0>(content_); }
  const T& operator*() const& { return std::get<0>(content_); }
  T&& operator*() && { return std::get<0>(std::move(content_)); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }
  const Failure& failure() const { return std::get<1>(content_); }

 private:
  std::variant<T, Failure> content_;
};

/// Ends the process when a programmer's assumption does not hold; never used on input from outside.
inline void check(bool holds, const char* why) {
  if (holds) return;
  std::fprintf(stderr, "aureole renderer: broken invariant: %s\n", why);
  std::abort();
}

}  // namespace aureole::render
