// Reading JSON from strangers: typed access that remembers where it is and keeps the first mistake.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace aureole {

/// Arrays and objects deeper than this are refused before they are built.
inline constexpr std::size_t json_depth_max = 16;

/// The first mistake of one reading. Later ones are usually its consequences and are dropped;
/// readers go on with defaults, so that no reading code needs a branch for errors.
class JsonProblems {
 public:
  explicit JsonProblems(std::string_view where) : where_(where) {}
  /// Records "where: path: sentence" unless something was recorded before.
  void add(std::string_view path, std::string_view sentence);
  bool any() const { return first_.has_value(); }
  Error error() const { return *first_; }

 private:
  std::string where_;
  std::optional<Error> first_;
};

/// Closed or half-open ranges of numbers, with the unit that errors name.
struct NumberRange {
  double min = 0;
  double max = 0;
  std::string_view unit = "";
  bool above_min = false;  ///< min itself is refused.
};

/// One value of a document and its JSON pointer. Getters never fail: what does not fit is recorded
/// and a default is returned. The document and the problems must outlive it.
class JsonNode {
 public:
  JsonNode(const nlohmann::json& value, std::string path, JsonProblems& problems)
      : value_(&value), path_(std::move(path)), problems_(&problems) {}

  const std::string& path() const { return path_; }
  JsonProblems& problems() const { return *problems_; }
  bool ok() const { return !problems_->any(); }
  bool is_object() const;
  bool is_array() const;
  bool is_string() const;

  /// "found <this value>, expected <expected>"
  void expected(std::string_view expected) const;
  /// Any other sentence about this value.
  void refuse(std::string_view sentence) const;

  /// An object with no other keys than these; the unknown one is named, with the likeliest meaning.
  bool object(std::initializer_list<std::string_view> keys) const;
  bool has(std::string_view key) const;
  /// The value under a key; a missing one is recorded. Without an object: a null in its place.
  JsonNode at(std::string_view key) const;
  std::optional<JsonNode> find(std::string_view key) const;
  /// All members of an object, sorted by key.
  std::vector<std::pair<std::string, JsonNode>> members() const;
  /// The elements of an array of min … max elements; empty after a mistake.
  std::vector<JsonNode> items(std::size_t min, std::size_t max) const;

  double number(const NumberRange& range) const;
  std::int64_t integer(std::int64_t min, std::int64_t max) const;
  bool boolean() const;
  std::string text(std::size_t length_max) const;

 private:
  JsonNode member(std::string_view key, const nlohmann::json& value) const;

  const nlohmann::json* value_;
  std::string path_;
  JsonProblems* problems_;
};

/// A parsed text. Refused with line and column: bad syntax (NaN and Infinity are no JSON), numbers
/// too large for a double, nesting past json_depth_max, a key that an object has twice.
class JsonDocument {
 public:
  static Result<JsonDocument> parse(std::string_view text, std::string_view where);
  JsonNode root(JsonProblems& problems) const;

 private:
  std::shared_ptr<const nlohmann::json> value_;
};

/// The candidate closest to `word` by edit distance, if it is close enough to have been meant.
std::optional<std::string> likely_meant(std::string_view word,
                                        const std::vector<std::string>& candidates);

}  // namespace aureole
