// Comparing a drawn image with an expected one, with room for another rasteriser's rounding.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "renderer/pixels.h"

namespace aureole::test {

/// Top-down rows of red, green, blue.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  friend bool operator==(const Image&, const Image&) = default;
};

Image image_from(const render::Pixels& pixels);

/// How far two images may lie apart. A pixel fails if one of its channels differs by more than
/// `channel_difference`. The mean is taken over all channels of all pixels. Whoever loosens one of
/// these says why in a comment.
struct Tolerance {
  int channel_difference = 0;   ///< 0 … 255
  double failing_fraction = 0;  ///< Of all pixels, 0 … 1.
  double mean_difference = 0;   ///< 0 … 255
};

struct ImageComparison {
  bool matches = false;
  int maximum_difference = 0;
  double mean_difference = 0;
  double failing_fraction = 0;
  /// What was measured and allowed, and a map of the image with a character for each of 64 x 16
  /// areas: blank where nothing fails, '.', ':', '+', '#' the more pixels fail.
  std::string explanation;
  explicit operator bool() const { return matches; }
};
/// So that a failed REQUIRE prints the explanation.
std::ostream& operator<<(std::ostream& out, const ImageComparison& comparison);

ImageComparison compare(const Image& actual, const Image& expected, const Tolerance& tolerance);

/// Compares with the golden image `tests/frames/golden/<name>.png`. If they do not match, writes
/// <name>.actual.png, .expected.png and .difference.png (eight times the difference) into the
/// folder that AUREOLE_ARTEFACTS names, or `artefacts` in the build folder. With
/// AUREOLE_UPDATE_GOLDEN=1 in the environment it writes the golden image instead, and matches.
ImageComparison check_golden(const std::string& name, const Image& image,
                             const Tolerance& tolerance);

/// The golden image of that name; empty if there is none.
Image golden_image(const std::string& name);

}  // namespace aureole::test
