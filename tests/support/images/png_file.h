// PNG files in and out, for tests.
#pragma once

#include <optional>
#include <string>

#include "tests/support/images/compare_images.h"

namespace aureole::test {

/// Empty if the file is missing or no PNG image.
std::optional<Image> read_png(const std::string& path);

/// False if the file cannot be written.
bool write_png(const std::string& path, const Image& image);

}  // namespace aureole::test
