// Bad input is a value, not an exception: a sentence that a person can act on.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <variant>

namespace aureole {

/// What was wrong, where, and what was expected; one sentence.
struct Error {
  std::string message;

  template <class... Args>
  static Error format(fmt::format_string<Args...> text, Args&&... args) {
    return {fmt::format(text, std::forward<Args>(args)...)};
  }
};

/// Either a value or an Error. `if (!r) return r.error();`
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() & { return std::get<0>(content_); }
  const T& operator*() const& { return std::get<0>(content_); }
  T&& operator*() && { return std::get<0>(std::move(content_)); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }
  const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

/// Success without a value.
struct Ok {};
using Status = Result<Ok>;

}  // namespace aureole
