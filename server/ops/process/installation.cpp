// Asks the kernel for the executable's path; see installation.h.
#include "server/ops/process/installation.h"

namespace aureole {

std::filesystem::path executable_path() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::string web_root_beside(const std::filesystem::path& executable) {
  const auto folder = executable.parent_path().parent_path();
  const auto built = folder / "web";
  const auto installed = folder / "share/aureole/web";
  std::error_code ignored;
  const bool is_installed = !std::filesystem::exists(built / "index.html", ignored) &&
                            std::filesystem::exists(installed / "index.html", ignored);
  return (is_installed ? installed : built).string();
}

}  // namespace aureole
