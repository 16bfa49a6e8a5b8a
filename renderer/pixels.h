// A drawn frame in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aureole::render {

/// Four bytes a pixel: blue, green, red, unused. Rows without padding.
struct Pixels {
  int width = 0, height = 0;
  /// OpenGL's order: the first row is the lowest of the picture. TurboJPEG turns it over for free.
  bool bottom_up = true;
  std::vector<std::uint8_t> bgrx;

  /// Row counted from the top of the picture, `width` × 4 bytes.
  const std::uint8_t* row(int from_top) const {
    const int stored = bottom_up ? height - 1 - from_top : from_top;
    return bgrx.data() + static_cast<std::size_t>(stored) * static_cast<std::size_t>(width) * 4;
  }
};

}  // namespace aureole::render
