// JPEG from drawn frames and back, by TurboJPEG.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "renderer/outcome.h"
#include "renderer/pixels.h"

namespace aureole::render {

/// Keeps its buffer from frame to frame; one encoder belongs to one thread at a time.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(JpegEncoder&&) noexcept;
  JpegEncoder& operator=(JpegEncoder&&) noexcept;

  /// One baseline JPEG image with 4:2:0 chroma. `quality` 1 … 100. The bytes stay valid until the
  /// next call. Fails on an empty frame, a quality out of range, and when the library runs out of
  /// memory.
  Outcome<std::span<const std::uint8_t>> encode(const Pixels& pixels, int quality);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Decodes an image of at most 3840 x 2160 pixels, top-down. Takes bytes from anywhere: whatever is
/// not a JPEG image of that size is a failure.
Outcome<Pixels> decode_jpeg(std::span<const std::uint8_t> jpeg);

}  // namespace aureole::render
