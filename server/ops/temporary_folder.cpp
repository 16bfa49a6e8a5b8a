// Making, locking and clearing away; see temporary_folder.h.
#include "server/ops/temporary_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace aureole {
namespace {

constexpr std::string_view folder_prefix = "aureole-state-";
constexpr std::string_view folder_end = "XXXXXX";

int open_folder(const std::filesystem::path& path) {
  return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// Whether the folder that is open is this user's and still the one of that name.
bool is_ours(int fd, const std::filesystem::path& path) {
  using About = struct stat;
  About held{};
  About named{};
  return fstat(fd, &held) == 0 && lstat(path.c_str(), &named) == 0 && held.st_uid == geteuid() &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

/// Removes the folder if nobody holds it.
void remove_if_abandoned(const std::filesystem::path& path) {
  const int fd = open_folder(path);
  if (fd < 0) return;
  std::error_code ignored;
  if (is_ours(fd, path) && flock(fd, LOCK_EX | LOCK_NB) == 0 && is_ours(fd, path))
    std::filesystem::remove_all(path, ignored);
  close(fd);
}

void remove_abandoned(const std::filesystem::path& parent) {
  std::error_code failed;
  std::vector<std::filesystem::path> found;
  for (auto at = std::filesystem::directory_iterator(parent, failed);
       !failed && at != std::filesystem::directory_iterator(); at.increment(failed)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(folder_prefix) && name.size() == folder_prefix.size() + folder_end.size())
      found.push_back(at->path());
  }
  for (const auto& path : found) remove_if_abandoned(path);
}

}  // namespace

Result<std::unique_ptr<TemporaryFolder>> TemporaryFolder::make() {
  std::error_code none;
  const bool has_memory =
      std::filesystem::is_directory("/dev/shm", none) && access("/dev/shm", W_OK) == 0;
  return make(has_memory ? std::filesystem::path("/dev/shm")
                         : std::filesystem::temp_directory_path(none));
}

Result<std::unique_ptr<TemporaryFolder>> TemporaryFolder::make(
    const std::filesystem::path& parent) {
  remove_abandoned(parent);
  // Between making a folder and locking it another process may take it for an abandoned one.
  constexpr int attempts = 100;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    std::string pattern = (parent / folder_prefix).string().append(folder_end);
    if (mkdtemp(pattern.data()) == nullptr)
      return Error::format("cannot make a folder in {}: {}", parent.string(), std::generic_category().message(errno));
    const int fd = open_folder(pattern);
    if (fd < 0 && errno != ENOENT) {
      const std::string why = std::generic_category().message(errno);
      rmdir(pattern.c_str());
      return Error::format("cannot open {}: {}", pattern, why);
    }
    if (fd < 0) continue;
    // Whoever has it locked is removing it.
    if (flock(fd, LOCK_EX) == 0 && is_ours(fd, pattern))
      return std::unique_ptr<TemporaryFolder>(new TemporaryFolder(pattern, fd));
    close(fd);
  }
  return Error::format("cannot keep a folder in {}: others removed {} of them at once",
                       parent.string(), attempts);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  close(held_);
}

}  // namespace aureole
