// Builds a JSON tree from text while watching depth, doubled keys and the place of each mistake.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "server/worlds/reading/json_reader.h"

namespace aureole {
namespace {

using nlohmann::json;

std::string escaped(std::string_view key) {
  std::string out;
  for (char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

/// "line 3, column 7" of a byte offset.
std::string place_in(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
  return fmt::format("line {}, column {}", line,
                     std::max<std::size_t>(1, before.size() - line_start));
}

/// nlohmann's event interface; returning false ends the parse.
class TreeBuilder : public json::json_sax_t {
 public:
  TreeBuilder(std::string_view text, std::string_view where) : text_(text), where_(where) {}

  json take() { return std::move(root_); }
  std::optional<Error> error() const { return error_; }

  bool null() override { return put(json(nullptr)); }
  bool boolean(bool v) override { return put(json(v)); }
  bool number_integer(number_integer_t v) override { return put(json(v)); }
  bool number_unsigned(number_unsigned_t v) override { return put(json(v)); }
  bool number_float(number_float_t v, const string_t&) override { return put(json(v)); }
  bool string(string_t& v) override { return put(json(std::move(v))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& k) override {
    Level& top = levels_.back();
    if (!top.value->emplace(k, nullptr).second) {
      error_ = Error::format("{}: {}/{}: the key is there twice, expected once", where_, path(),
                             escaped(k));
      return false;
    }
    top.key = std::move(k);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& last_token,
                   const json::exception& exception) override {
    if (exception.id == 406) {
      error_ = Error::format("{}: {}: found the number {}, expected one that fits a double", where_,
                             place_in(text_, position), last_token);
      return false;
    }
    // The library's sentence without its own prefix and place, which are said better here.
    std::string_view why = exception.what();
    if (const auto colon = why.find(": "); colon != why.npos) why.remove_prefix(colon + 2);
    error_ = Error::format("{}: {}: not JSON: {}", where_, place_in(text_, position), why);
    return false;
  }

 private:
  struct Level {
    json* value;
    std::string key;
  };

  json* slot(json&& v) {
    if (levels_.empty()) {
      root_ = std::move(v);
      return &root_;
    }
    Level& top = levels_.back();
    if (top.value->is_array()) {
      top.value->push_back(std::move(v));
      return &top.value->back();
    }
    json& place = (*top.value)[top.key];
    place = std::move(v);
    return &place;
  }
  bool put(json&& v) {
    slot(std::move(v));
    return true;
  }
  bool open(json&& v) {
    if (levels_.size() >= json_depth_max) {
      error_ = Error::format("{}: {}: found more than {} levels of nesting, expected fewer", where_,
                             path(), json_depth_max);
      return false;
    }
    // An element of an array moves only while it is complete, so open levels stay where they are.
    json* place = slot(std::move(v));
    levels_.push_back({place, {}});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }
  std::string path() const {
    std::string out;
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const Level& level = levels_[i];
      const bool innermost = i + 1 == levels_.size();
      if (level.value->is_array()) {
        const std::size_t next = level.value->size();
        out += fmt::format("/{}", innermost || next == 0 ? next : next - 1);
      } else if (!innermost) {
        out += "/" + escaped(level.key);
      }
    }
    return out;
  }

  std::string_view text_;
  std::string_view where_;
  json root_;
  std::vector<Level> levels_;
  std::optional<Error> error_;
};

}  // namespace

Result<JsonDocument> JsonDocument::parse(std::string_view text, std::string_view where) {
  TreeBuilder builder(text, where);
  const bool complete = json::sax_parse(text.begin(), text.end(), &builder);
  if (builder.error()) return *builder.error();
  if (!complete) return Error::format("{}: not JSON", where);
  JsonDocument document;
  document.value_ = std::make_shared<const json>(builder.take());
  return document;
}

JsonNode JsonDocument::root(JsonProblems& problems) const {
  return {*value_, "", problems};
}

}  // namespace aureole
