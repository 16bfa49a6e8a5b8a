// Reads a world from a JSON file; every mistake gets a sentence with file, JSON path, finding and
// expectation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/worlds/world.h"

namespace aureole {

struct WorldFileOptions {
  /// Splits the world's bounds anew into this many regions: 1, 2, 4, 9 as a grid (2 as two
  /// columns), other numbers as columns; without it the file's own rectangles count. 1 … 64.
  std::optional<int> regions = {};
  /// Instead of the file's own "mode".
  std::optional<MigrationMode> mode = {};
};

/// `path` may also be the bare name of a shipped world ("playground").
/// Errors: unreadable file, bad JSON, unknown or missing keys, numbers out of range or not finite,
/// duplicate names, regions that overlap, leave gaps or are narrower than 4 aura radii.
Result<WorldDefinition> load_world(const std::filesystem::path& path,
                                   const WorldFileOptions& options = {});

/// The same from text; `where` stands for the file's name in errors.
Result<WorldDefinition> parse_world(std::string_view text, std::string_view where,
                                    const WorldFileOptions& options = {});

}  // namespace aureole
