// Files of the web page, and nothing else of the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace aureole {

struct StaticFile {
  std::string content_type;
  std::string etag;  ///< Of size and time of change, quoted.
  std::string body;
};

/// "%41" becomes "A". Nothing if a sign of per cent is not followed by two hex digits.
std::optional<std::string> percent_decoded(std::string_view text);

/// By extension; "application/octet-stream" for those unknown.
std::string_view content_type_of(const std::filesystem::path& file);

class StaticFiles {
 public:
  static constexpr std::uintmax_t max_file_bytes = 16u << 20;

  explicit StaticFiles(const std::filesystem::path& root);

  /// `url_path` as in the request, without query. "/" and folders mean their index.html; a name
  /// without extension also finds the .html file. Nothing for whatever is not a regular file inside
  /// the root (by its real path: links that lead outside do not count), and for hidden files.
  std::optional<StaticFile> load(std::string_view url_path) const;

 private:
  std::filesystem::path root_;  ///< Canonical; empty if there is none.
};

}  // namespace aureole
