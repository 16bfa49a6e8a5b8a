// A smallest valid world as text, and ways to change one thing in it.
#pragma once

#include <string>
#include <string_view>

#include "server/worlds/world_file.h"

namespace aureole::test {

/// Replaces the first `from` by `to`; the text unchanged if it is not there (a test would then
/// fail).
inline std::string with(std::string text, std::string_view from, std::string_view to) {
  const auto at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline const std::string small_world = R"({
  "name": "small",
  "bounds": { "min": [-100, -10, -100], "max": [100, 50, 100] },
  "max_bodies": 50,
  "regions": [ { "name": "west", "area": { "max_x": 0 } }, { "name": "east", "area": { "min_x": 0 } } ],
  "definitions": { "ball": { "shape": { "type": "sphere", "radius": 0.5 }, "mass_kg": 2 } },
  "statics": [ { "name": "ground", "shape": { "type": "plane" }, "position": [0, 0, 0] } ],
  "bodies": [ { "body": "ball", "position": [1, 2, 3] } ],
  "injectors": [ { "name": "rain", "rate_per_s": 10, "volume": { "min": [0, 5, 0], "max": [1, 6, 1] },
                   "mix": [ { "body": "ball" } ] } ],
  "spawn_points": [ { "position": [0, 1, 0] } ]
})";

inline Result<WorldDefinition> parse(const std::string& text,
                                     const WorldFileOptions& options = {}) {
  return parse_world(text, "w.json", options);
}

/// The small world with these "bodies".
inline Result<WorldDefinition> parse_bodies(const std::string& bodies) {
  return parse(with(small_world, R"([ { "body": "ball", "position": [1, 2, 3] } ])", bodies));
}

}  // namespace aureole::test
