// Comparing a drawn image with an expected one, with room for another rasteriser's rounding.
#include "tests/support/images/compare_images.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <sstream>

#include "tests/support/images/png_file.h"

namespace aureole::test {
namespace {

constexpr int map_columns = 64, map_rows = 16;

std::size_t pixel_offset(const Image& image, int x, int y) {
  return (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
          static_cast<std::size_t>(x)) *
         3;
}

int difference_at(const Image& a, const Image& b, std::size_t k) {
  return std::abs(static_cast<int>(a.rgb[k]) - static_cast<int>(b.rgb[k]));
}

std::string map_of(const std::array<double, map_columns * map_rows>& share) {
  std::string text;
  for (int row = 0; row < map_rows; ++row) {
    text += "\n  |";
    for (int column = 0; column < map_columns; ++column) {
      const double s = share[static_cast<std::size_t>(row * map_columns + column)];
      text += s <= 0 ? ' ' : s < 0.02 ? '.' : s < 0.1 ? ':' : s < 0.4 ? '+' : '#';
    }
    text += '|';
  }
  return text;
}

std::filesystem::path artefacts_folder() {
  const char* folder = std::getenv("AUREOLE_ARTEFACTS");
  return folder != nullptr && *folder != '\0' ? folder : AUREOLE_ARTEFACTS_FOLDER;
}

std::string golden_path(const std::string& name) {
  return std::string(AUREOLE_GOLDEN_FOLDER) + "/" + name + ".png";
}

// Sizes are equal.
Image difference_image(const Image& a, const Image& b) {
  Image result{a.width, a.height, std::vector<std::uint8_t>(a.rgb.size())};
  for (std::size_t k = 0; k < a.rgb.size(); ++k)
    result.rgb[k] = static_cast<std::uint8_t>(std::min(255, 8 * difference_at(a, b, k)));
  return result;
}

void write_artefacts(const std::string& name, const Image& actual, const Image& expected,
                     std::string& explanation) {
  const auto folder = artefacts_folder();
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const std::string stem = (folder / name).string();
  bool written = write_png(stem + ".actual.png", actual);
  if (expected.width > 0) written = write_png(stem + ".expected.png", expected) && written;
  if (expected.width == actual.width && expected.height == actual.height)
    written = write_png(stem + ".difference.png", difference_image(actual, expected)) && written;
  explanation +=
      (written ? "\nsee " : "\ncould not write ") + stem + ".{actual,expected,difference}.png";
}

}  // namespace

Image image_from(const render::Pixels& pixels) {
  Image image{pixels.width, pixels.height, {}};
  image.rgb.reserve(pixels.bgrx.size() / 4 * 3);
  for (int y = 0; y < pixels.height; ++y) {
    const std::uint8_t* row = pixels.row(y);
    for (int x = 0; x < pixels.width; ++x) {
      const std::uint8_t* p = row + 4 * static_cast<std::ptrdiff_t>(x);
      image.rgb.insert(image.rgb.end(), {p[2], p[1], p[0]});
    }
  }
  return image;
}

std::ostream& operator<<(std::ostream& out, const ImageComparison& comparison) {
  return out << comparison.explanation;
}

ImageComparison compare(const Image& actual, const Image& expected, const Tolerance& tolerance) {
  ImageComparison result;
  std::ostringstream text;
  if (actual.width != expected.width || actual.height != expected.height || actual.rgb.empty() ||
      actual.rgb.size() != expected.rgb.size()) {
    text << "the image has " << actual.width << " x " << actual.height << " pixels, expected "
         << expected.width << " x " << expected.height;
    result.explanation = text.str();
    return result;
  }
  std::array<double, map_columns * map_rows> failing_in{}, pixels_in{};
  double sum = 0, failing = 0;
  for (int y = 0; y < actual.height; ++y) {
    for (int x = 0; x < actual.width; ++x) {
      int largest = 0;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const int d = difference_at(actual, expected, pixel_offset(actual, x, y) + channel);
        sum += d;
        largest = std::max(largest, d);
      }
      result.maximum_difference = std::max(result.maximum_difference, largest);
      const auto area = static_cast<std::size_t>(y * map_rows / actual.height * map_columns +
                                                 x * map_columns / actual.width);
      pixels_in[area] += 1;
      if (largest <= tolerance.channel_difference) continue;
      failing_in[area] += 1;
      failing += 1;
    }
  }
  result.mean_difference = sum / static_cast<double>(actual.rgb.size());
  result.failing_fraction = failing * 3 / static_cast<double>(actual.rgb.size());
  result.matches = result.mean_difference <= tolerance.mean_difference &&
                   result.failing_fraction <= tolerance.failing_fraction;
  text << "largest difference " << result.maximum_difference << ", mean " << result.mean_difference
       << " (allowed " << tolerance.mean_difference << "), " << failing
       << " pixels = " << 100 * result.failing_fraction << " % differ by more than "
       << tolerance.channel_difference << " (allowed " << 100 * tolerance.failing_fraction << " %)";
  if (failing > 0) {
    for (std::size_t k = 0; k < failing_in.size(); ++k)
      failing_in[k] = pixels_in[k] > 0 ? failing_in[k] / pixels_in[k] : 0;
    text << "; where:" << map_of(failing_in);
  }
  result.explanation = text.str();
  return result;
}

Image golden_image(const std::string& name) {
  return read_png(golden_path(name)).value_or(Image{});
}

ImageComparison check_golden(const std::string& name, const Image& image,
                             const Tolerance& tolerance) {
  const char* update = std::getenv("AUREOLE_UPDATE_GOLDEN");
  if (update != nullptr && std::string(update) == "1") {
    ImageComparison result;
    result.matches = write_png(golden_path(name), image);
    result.explanation = (result.matches ? "wrote " : "could not write ") + golden_path(name);
    return result;
  }
  const Image expected = golden_image(name);
  ImageComparison result = compare(image, expected, tolerance);
  if (expected.width == 0) {
    result.explanation = "there is no golden image " + golden_path(name) +
                         "; run once with AUREOLE_UPDATE_GOLDEN=1 and look at it";
  }
  if (!result.matches) write_artefacts(name, image, expected, result.explanation);
  return result;
}

}  // namespace aureole::test
