// One OpenGL context, renderer and encoder for each render thread.
#include "server/gateway/pictures/picture_maker.h"

#include <chrono>

#include "renderer/gl/offscreen_context.h"
#include "renderer/jpeg_encoder.h"
#include "renderer/renderer.h"

namespace aureole {
namespace {

using Clock = std::chrono::steady_clock;

std::uint32_t us_between(Clock::time_point from, Clock::time_point to) {
  return static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(to - from).count());
}

class RendererPictureMaker : public PictureMaker {
 public:
  explicit RendererPictureMaker(std::unique_ptr<render::Renderer> renderer)
      : renderer_(std::move(renderer)) {}

  Result<Picture> make(const PictureRequest& request) override {
    const auto started = Clock::now();
    const render::Pixels& pixels = renderer_->render(*request.scene, request.view);
    const auto rendered = Clock::now();

    Picture picture;
    if (request.format == PictureFormat::ppm) {
      picture.bytes = std::make_shared<const std::vector<std::byte>>(to_ppm(pixels));
    } else {
      const auto jpeg = encoder_.encode(pixels, request.quality);
      if (!jpeg) return Error{jpeg.failure().message};
      const auto bytes = std::as_bytes(*jpeg);
      picture.bytes = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
    }
    picture.render_us = us_between(started, rendered);
    picture.encode_us = us_between(rendered, Clock::now());
    return picture;
  }

 private:
  std::unique_ptr<render::Renderer> renderer_;
  render::JpegEncoder encoder_;
};

}  // namespace

std::vector<std::byte> to_ppm(const render::Pixels& pixels) {
  const std::string head = fmt::format("P6\n{} {}\n255\n", pixels.width, pixels.height);
  std::vector<std::byte> out;
  out.reserve(head.size() +
              3 * static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height));
  for (const char c : head) out.push_back(static_cast<std::byte>(c));
  for (int y = 0; y < pixels.height; ++y) {
    const std::uint8_t* row = pixels.row(y);
    for (int x = 0; x < pixels.width; ++x, row += 4)
      for (const int channel : {2, 1, 0}) out.push_back(static_cast<std::byte>(row[channel]));
  }
  return out;
}

PictureMakerFactory make_picture_maker_factory(const SceneBuilder& builder) {
  // Measured: rasterising in the render thread itself gives the most pictures for each processor.
  render::configure_software_rasteriser(0);
  return [&builder]() -> Result<std::unique_ptr<PictureMaker>> {
    auto context = render::make_osmesa_context();
    if (!context) return Error{context.failure().message};
    auto renderer =
        render::Renderer::make(std::move(*context), builder.meshes(), builder.statics());
    if (!renderer) return Error{renderer.failure().message};
    return std::unique_ptr<PictureMaker>(
        std::make_unique<RendererPictureMaker>(std::move(*renderer)));
  };
}

}  // namespace aureole
