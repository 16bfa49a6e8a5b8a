// Turning a hostile path into a file inside one folder.
#include "server/gateway/web/static_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>
#include <utility>

namespace aureole {
namespace fs = std::filesystem;
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Neither empty, nor hidden, nor "." or "..", nor with signs that no file of ours has.
bool is_harmless(std::string_view segment) {
  if (segment.empty() || segment.front() == '.') return false;
  return std::all_of(segment.begin(), segment.end(),
                     [](char c) { return c >= 0x20 && c != 0x7f && c != '\\' && c != ':'; });
}

/// The path below the root that is meant, or nothing.
std::optional<fs::path> relative_path(std::string_view url_path) {
  const auto decoded = percent_decoded(url_path);
  if (!decoded || decoded->empty() || decoded->front() != '/') return std::nullopt;
  fs::path relative;
  std::string_view rest = std::string_view(*decoded).substr(1);
  while (!rest.empty()) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string_view segment = rest.substr(0, slash);
    if (!is_harmless(segment)) return std::nullopt;
    relative /= segment;
    rest.remove_prefix(std::min(slash + 1, rest.size()));
  }
  if (decoded->back() == '/') relative /= "index.html";
  return relative;
}

bool is_inside(const fs::path& file, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), file.begin(), file.end()).first == root.end();
}

}  // namespace

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

std::string_view content_type_of(const fs::path& file) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 14> types = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".wasm", "application/wasm"},
      {".txt", "text/plain; charset=utf-8"},
      {".webmanifest", "application/manifest+json"},
  }};
  const std::string extension = file.extension().string();
  for (const auto& [ending, type] : types)
    if (ending == extension) return type;
  return "application/octet-stream";
}

StaticFiles::StaticFiles(const fs::path& root) {
  std::error_code failed;
  if (!root.empty()) root_ = fs::canonical(root, failed);
  if (failed) root_.clear();
}

std::optional<StaticFile> StaticFiles::load(std::string_view url_path) const {
  const auto relative = relative_path(url_path);
  if (root_.empty() || !relative) return std::nullopt;
  std::error_code failed;
  fs::path file = fs::canonical(root_ / *relative, failed);
  if (failed && !relative->has_extension()) {
    fs::path page = root_ / *relative;
    page += ".html";
    file = fs::canonical(page, failed);
  }
  if (failed || !is_inside(file, root_) || !fs::is_regular_file(file, failed)) return std::nullopt;
  const std::uintmax_t size = fs::file_size(file, failed);
  if (failed || size > max_file_bytes) return std::nullopt;
  const auto changed = fs::last_write_time(file, failed);
  if (failed) return std::nullopt;

  StaticFile found;
  found.content_type = content_type_of(file);
  found.etag = fmt::format("\"{:x}-{:x}\"", size, changed.time_since_epoch().count());
  found.body.resize(static_cast<std::size_t>(size));
  std::ifstream in(file, std::ios::binary);
  // A file that is being replaced may have become shorter: then it is not there just now.
  if (!in.read(found.body.data(), static_cast<std::streamsize>(size))) return std::nullopt;
  return found;
}

}  // namespace aureole
