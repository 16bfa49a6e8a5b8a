// JPEG: what is encoded comes back within a bound, and bad input is an error value.
#include <cstdlib>

#include "renderer/jpeg_encoder.h"
#include "tests/support/catch.h"

namespace aureole::render {
namespace {

// A soft gradient with one bright square in the upper left corner of the picture.
Pixels picture(int width, int height, bool bottom_up) {
  Pixels pixels{width, height, bottom_up, {}};
  pixels.bgrx.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  for (int y = 0; y < height; ++y) {
    auto* row = const_cast<std::uint8_t*>(pixels.row(y));
    for (int x = 0; x < width; ++x) {
      const bool square = x < 32 && y < 32;
      row[4 * x] = static_cast<std::uint8_t>(square ? 20 : 60 + 100 * x / width);
      row[4 * x + 1] = static_cast<std::uint8_t>(square ? 40 : 80 + 100 * y / height);
      row[4 * x + 2] = static_cast<std::uint8_t>(square ? 240 : 90);
    }
  }
  return pixels;
}

double mean_difference(const Pixels& a, const Pixels& b) {
  double sum = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c) sum += std::abs(a.row(y)[4 * x + c] - b.row(y)[4 * x + c]);
  return sum / (3.0 * a.width * a.height);
}

}  // namespace

TEST_CASE("A picture comes back from JPEG nearly as it was, the right way up in either row order") {
  JpegEncoder encoder;
  for (const bool bottom_up : {false, true}) {
    const Pixels original = picture(320, 200, bottom_up);
    const auto jpeg = encoder.encode(original, 85);
    REQUIRE(jpeg);
    const auto decoded = decode_jpeg(*jpeg);
    REQUIRE(decoded);
    REQUIRE(decoded->width == 320);
    REQUIRE(decoded->height == 200);
    // A gradient at quality 85 loses less than two levels on average; upside down it would be
    // dozens.
    CHECK(mean_difference(original, *decoded) < 2.0);
  }
}

TEST_CASE("Lower quality makes fewer bytes") {
  JpegEncoder encoder;
  const Pixels original = picture(320, 200, true);
  const auto fine = encoder.encode(original, 95);
  REQUIRE(fine);
  const std::size_t fine_bytes = fine->size();
  const auto coarse = encoder.encode(original, 20);
  REQUIRE(coarse);
  CHECK(coarse->size() < fine_bytes);
}

TEST_CASE("Empty frames and impossible qualities are errors") {
  JpegEncoder encoder;
  CHECK(!encoder.encode(Pixels{}, 75));
  Pixels torn = picture(64, 64, true);
  torn.bgrx.pop_back();
  CHECK(!encoder.encode(torn, 75));
  const Pixels whole = picture(64, 64, true);
  CHECK(!encoder.encode(whole, 0));
  CHECK(!encoder.encode(whole, 101));
  CHECK(encoder.encode(whole, 1));
  CHECK(encoder.encode(whole, 100));
}

TEST_CASE("Bytes that are no JPEG image are errors") {
  CHECK(!decode_jpeg({}));
  const std::vector<std::uint8_t> noise(1000, 0x5a);
  CHECK(!decode_jpeg(noise));
  JpegEncoder encoder;
  const auto jpeg = encoder.encode(picture(64, 64, true), 75);
  REQUIRE(jpeg);
  CHECK(!decode_jpeg(jpeg->first(20)));
}

}  // namespace aureole::render
