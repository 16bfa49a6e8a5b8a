// JPEG from drawn frames and back, by TurboJPEG.
#include "renderer/jpeg_encoder.h"

#include <turbojpeg.h>

#include <string>

namespace aureole::render {
namespace {

struct HandleCloser {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, HandleCloser>;

std::string reason(const Handle& handle) {
  const char* text = tjGetErrorStr2(handle.get());
  return text != nullptr ? text : "no reason given";
}

}  // namespace

struct JpegEncoder::State {
  Handle handle{tjInitCompress()};
  std::vector<std::uint8_t> buffer;
};

JpegEncoder::JpegEncoder() : state_(std::make_unique<State>()) {}
JpegEncoder::~JpegEncoder() = default;
JpegEncoder::JpegEncoder(JpegEncoder&&) noexcept = default;
JpegEncoder& JpegEncoder::operator=(JpegEncoder&&) noexcept = default;

Outcome<std::span<const std::uint8_t>> JpegEncoder::encode(const Pixels& pixels, int quality) {
  State& s = *state_;
  if (!s.handle) return Failure{"TurboJPEG cannot start an encoder; is memory exhausted?"};
  if (quality < 1 || quality > 100)
    return Failure{"JPEG quality is " + std::to_string(quality) + ", expected 1 to 100"};
  const auto expected =
      static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height) * 4;
  if (pixels.width < 1 || pixels.height < 1 || pixels.bgrx.size() != expected)
    return Failure{"a frame without pixels cannot be encoded"};
  // The library's bound on any image of this size: it never has to reallocate.
  const unsigned long bound = tjBufSize(pixels.width, pixels.height, TJSAMP_420);
  if (s.buffer.size() < bound) s.buffer.resize(bound);
  unsigned char* target = s.buffer.data();
  unsigned long size = s.buffer.size();
  // The fast DCT loses accuracy that is visible only above quality 90.
  const int flags = TJFLAG_NOREALLOC | (quality <= 90 ? TJFLAG_FASTDCT : 0) |
                    (pixels.bottom_up ? TJFLAG_BOTTOMUP : 0);
  if (tjCompress2(s.handle.get(), pixels.bgrx.data(), pixels.width, 0, pixels.height, TJPF_BGRX,
                  &target, &size, TJSAMP_420, quality, flags) != 0)
    return Failure{"TurboJPEG cannot encode the frame: " + reason(s.handle)};
  return std::span<const std::uint8_t>(s.buffer.data(), size);
}

Outcome<Pixels> decode_jpeg(std::span<const std::uint8_t> jpeg) {
  const Handle handle(tjInitDecompress());
  if (!handle) return Failure{"TurboJPEG cannot start a decoder; is memory exhausted?"};
  int width = 0, height = 0, subsampling = 0, colours = 0;
  if (tjDecompressHeader3(handle.get(), jpeg.data(), jpeg.size(), &width, &height, &subsampling,
                          &colours) != 0)
    return Failure{"this is not a JPEG image: " + reason(handle)};
  if (width < 1 || height < 1 || width > 3840 || height > 2160) {
    return Failure{"the JPEG image is " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels, expected at most 3840 x 2160"};
  }
  Pixels pixels{width, height, false, {}};
  pixels.bgrx.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  if (tjDecompress2(handle.get(), jpeg.data(), jpeg.size(), pixels.bgrx.data(), width, 0, height,
                    TJPF_BGRX, TJFLAG_ACCURATEDCT) != 0)
    return Failure{"the JPEG image is damaged: " + reason(handle)};
  return pixels;
}

}  // namespace aureole::render
