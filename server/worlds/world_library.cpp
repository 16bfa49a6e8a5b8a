// Finds world files by path or by the bare name of a shipped world, and reads them.
#include <algorithm>
#include <fstream>
#include <system_error>

#include "server/worlds/reading/json_reader.h"
#include "server/worlds/world_file.h"

namespace aureole {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t file_bytes_max = 16u << 20;

/// Where shipped worlds lie: the source tree this was built from, beside the executable, installed.
std::vector<fs::path> shipped_directories() {
  std::vector<fs::path> out{AUREOLE_WORLDS_SOURCE_DIR};
  std::error_code error;
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  if (!error) out.push_back(executable.parent_path().parent_path() / "share/aureole/worlds");
  out.emplace_back("/usr/share/aureole/worlds");
  return out;
}

std::vector<std::string> shipped_names() {
  std::vector<std::string> names;
  for (const fs::path& directory : shipped_directories()) {
    std::error_code error;
    fs::directory_iterator it(directory, error);
    for (; !error && it != fs::directory_iterator(); it.increment(error)) {
      const fs::path& file = it->path();
      // world.schema.json describes worlds and is none: its stem still has a dot.
      if (file.extension() == ".json" && !file.stem().has_extension())
        names.push_back(file.stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

Result<fs::path> found(const fs::path& path) {
  if (is_file(path)) return path;
  if (!path.empty() && !path.has_parent_path()) {
    for (const fs::path& directory : shipped_directories()) {
      const fs::path candidate = directory / (path.string() + ".json");
      if (is_file(candidate)) return candidate;
    }
  }
  std::error_code error;
  if (fs::exists(path, error))
    return Error::format("{}: found something that is not a plain file, expected a world file",
                         path.string());
  const std::vector<std::string> names = shipped_names();
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const auto meant = likely_meant(path.string(), names);
  return Error::format(
      "{}: found no such file, expected a world file or the name of a shipped world ({}){}",
      path.string(), list, meant ? fmt::format(": did you mean \"{}\"?", *meant) : "");
}

}  // namespace

Result<WorldDefinition> load_world(const std::filesystem::path& path,
                                   const WorldFileOptions& options) {
  const auto file = found(path);
  if (!file) return file.error();
  const std::string where = file->string();
  std::error_code error;
  const std::uintmax_t size = fs::file_size(*file, error);
  if (error) return Error::format("{}: cannot be read: {}", where, error.message());
  if (size > file_bytes_max) {
    return Error::format("{}: found a file of {} bytes, expected at most {}", where, size,
                         file_bytes_max);
  }
  std::ifstream in(*file, std::ios::binary);
  std::string text(static_cast<std::size_t>(size), '\0');
  if (!in || !in.read(text.data(), static_cast<std::streamsize>(size))) {
    return Error::format("{}: cannot be read: expected a file that this user may read", where);
  }
  return parse_world(text, where, options);
}

}  // namespace aureole
