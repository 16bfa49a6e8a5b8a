// Where this program and the files that came with it lie.
#pragma once

#include <filesystem>
#include <string>

namespace aureole {

/// The running executable, symbolic links resolved.
std::filesystem::path executable_path();

/// The folder of the built player page: `web` of the build folder that holds `executable`, or
/// share/aureole/web of the prefix that it is installed under; the first one if neither has a page.
std::string web_root_beside(const std::filesystem::path& executable);

}  // namespace aureole
