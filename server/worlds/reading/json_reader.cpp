// Typed access to a JSON tree: each value is checked where it is read, and mistakes are worded
// here.
#include "server/worlds/reading/json_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace aureole {
namespace {

using nlohmann::json;

const json null_value;

/// What an error shows of a value: short, on one line, whole for numbers and short texts.
std::string shown(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) {
    return fmt::format("an array of {} element{}", value.size(), value.size() == 1 ? "" : "s");
  }
  std::string out = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (out.size() > 60) out = out.substr(0, 57) + "...";
  return out;
}

std::string described(const NumberRange& r) {
  const std::string unit = r.unit.empty() ? "" : fmt::format(" {}", r.unit);
  return r.above_min ? fmt::format("a number above {:g} and up to {:g}{}", r.min, r.max, unit)
                     : fmt::format("a number from {:g} to {:g}{}", r.min, r.max, unit);
}

/// Longer words are no typing mistakes worth a guess.
constexpr std::size_t word_bytes_max = 64;

/// Of texts of up to word_bytes_max bytes.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::array<std::size_t, word_bytes_max + 1> row{};
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::string> likely_meant(std::string_view word,
                                        const std::vector<std::string>& candidates) {
  if (word.size() > word_bytes_max) return {};
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > word_bytes_max) continue;
    // "mass" for "mass_kg": the unit was forgotten.
    const bool unit_forgotten = candidate.starts_with(std::string(word) + "_");
    const std::size_t distance = unit_forgotten ? 0 : edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void JsonProblems::add(std::string_view path, std::string_view sentence) {
  if (first_) return;
  first_ = Error::format("{}: {}: {}", where_, path.empty() ? "/" : path, sentence);
}

bool JsonNode::is_object() const {
  return value_->is_object();
}
bool JsonNode::is_array() const {
  return value_->is_array();
}
bool JsonNode::is_string() const {
  return value_->is_string();
}

void JsonNode::expected(std::string_view what) const {
  if (ok()) problems_->add(path_, fmt::format("found {}, expected {}", shown(*value_), what));
}

void JsonNode::refuse(std::string_view sentence) const {
  problems_->add(path_, sentence);
}

bool JsonNode::object(std::initializer_list<std::string_view> keys) const {
  if (!value_->is_object()) {
    expected("an object");
    return false;
  }
  for (const auto& [key, value] : value_->items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const auto meant = likely_meant(key, {keys.begin(), keys.end()});
    std::string names;
    for (std::string_view k : keys) names += fmt::format("{}{}", names.empty() ? "" : ", ", k);
    member(key, value)
        .refuse(meant ? fmt::format("found an unknown key, did you mean \"{}\"?", *meant)
                      : fmt::format("found an unknown key, expected one of {}", names));
    return false;
  }
  return true;
}

bool JsonNode::has(std::string_view key) const {
  return value_->is_object() && value_->find(key) != value_->end();
}

JsonNode JsonNode::member(std::string_view key, const json& value) const {
  std::string path = path_ + "/";
  for (char c : key)
    path += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return {value, std::move(path), *problems_};
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
  if (!value_->is_object()) return {};
  const auto it = value_->find(key);
  if (it == value_->end()) return {};
  return member(key, *it);
}

JsonNode JsonNode::at(std::string_view key) const {
  if (auto found = find(key)) return *found;
  if (value_->is_object()) {
    refuse(fmt::format("found no key \"{}\", expected one", key));
  } else {
    expected("an object");
  }
  return member(key, null_value);
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  std::vector<std::pair<std::string, JsonNode>> out;
  if (!value_->is_object()) {
    expected("an object");
    return out;
  }
  for (const auto& [key, value] : value_->items()) out.emplace_back(key, member(key, value));
  return out;
}

std::vector<JsonNode> JsonNode::items(std::size_t min, std::size_t max) const {
  if (!value_->is_array() || value_->size() < min || value_->size() > max) {
    expected(min == max ? fmt::format("an array of {} elements", min)
                        : fmt::format("an array of {} to {} elements", min, max));
    return {};
  }
  std::vector<JsonNode> out;
  out.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i) {
    out.emplace_back((*value_)[i], fmt::format("{}/{}", path_, i), *problems_);
  }
  return out;
}

double JsonNode::number(const NumberRange& range) const {
  const double fallback = range.above_min ? range.max : range.min;
  if (!value_->is_number()) {
    expected("a number");
    return fallback;
  }
  const double v = value_->get<double>();
  const bool inside =
      std::isfinite(v) && v <= range.max && (range.above_min ? v > range.min : v >= range.min);
  if (!inside) {
    expected(described(range));
    return fallback;
  }
  return v;
}

std::int64_t JsonNode::integer(std::int64_t min, std::int64_t max) const {
  const bool whole = value_->is_number_integer();
  // A number past 2^63 reads as unsigned: compared as a double it is past every max as well.
  const double v = whole ? value_->get<double>() : 0;
  if (!whole || v < static_cast<double>(min) || v > static_cast<double>(max)) {
    expected(fmt::format("a whole number from {} to {}", min, max));
    return min;
  }
  return value_->get<std::int64_t>();
}

bool JsonNode::boolean() const {
  if (value_->is_boolean()) return value_->get<bool>();
  expected("true or false");
  return false;
}

std::string JsonNode::text(std::size_t length_max) const {
  if (!value_->is_string()) {
    expected("a text");
    return {};
  }
  std::string out = value_->get<std::string>();
  if (out.empty() || out.size() > length_max) {
    expected(fmt::format("a text of 1 to {} bytes", length_max));
    return {};
  }
  return out;
}

}  // namespace aureole
