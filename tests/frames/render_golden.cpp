// Frames of a fixed scene against golden images, and proof that the comparison can fail.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/frames/render_scene.h"
#include "tests/support/catch.h"

namespace aureole::test {
namespace {

// The body of that kind nearest to a place on the ground.
std::size_t body_near(const render::Scene& scene, float x, float z) {
  std::size_t best = 0;
  float best_distance = 1e30f;
  for (std::size_t k = 0; k < scene.instances.size(); ++k) {
    const auto& p = scene.instances[k].position;
    const float distance = std::hypot(p.x() - x, p.z() - z);
    if (distance < best_distance) best = k, best_distance = distance;
  }
  return best;
}

bool updating() {
  return std::getenv("AUREOLE_UPDATE_GOLDEN") != nullptr;
}

}  // namespace

TEST_CASE("The playground looks like its golden image") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  INFO(renderer->context().description());
  REQUIRE(check_golden("playground", draw(*renderer, fixed.demo.scene, fixed.view),
                       another_rasteriser));
}

TEST_CASE("Boundaries stand in the playground as in their golden image") {
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  fixed.view.show_boundaries = true;
  fixed.view.camera = render::demo_walk(40);
  INFO(renderer->context().description());
  REQUIRE(check_golden("playground_boundaries", draw(*renderer, fixed.demo.scene, fixed.view),
                       another_rasteriser));
}

TEST_CASE("A crowd of near and far bodies looks like its golden image") {
  const render::DemoScene crowd = render::make_demo_scene(2000);
  const auto renderer = make_renderer(crowd);
  render::View view = FixedScene().view;
  view.camera.eye = {-20, 14, 40};
  view.camera.yaw_rad = -0.5f;
  view.camera.pitch_rad = -0.22f;
  const Image image = draw(*renderer, crowd.scene, view);
  // Both ways of drawing are in the picture, or it would not test them.
  CHECK(renderer->timings().bodies_as_points > 300);
  CHECK(renderer->timings().bodies_as_triangles > 100);
  INFO(renderer->context().description());
  REQUIRE(check_golden("crowd", image, another_rasteriser));
}

TEST_CASE("The comparison fails when one body is missing") {
  if (updating()) return;
  const Image golden = golden_image("playground");
  REQUIRE(golden.width == 640);
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  // An avatar, a gem, and one domino of the row.
  for (const auto& [x, z] : {std::pair{-3.4f, 6.2f}, {3.2f, 8.1f}, {0.2f, 3.5f}}) {
    render::Scene scene = fixed.demo.scene;
    const std::size_t missing = body_near(scene, x, z);
    scene.instances.erase(scene.instances.begin() + static_cast<std::ptrdiff_t>(missing));
    const auto comparison = compare(draw(*renderer, scene, fixed.view), golden, another_rasteriser);
    INFO(comparison);
    CHECK(!comparison.matches);
  }
}

TEST_CASE("The comparison fails when the camera has moved by 1 cm") {
  if (updating()) return;
  const Image golden = golden_image("playground");
  REQUIRE(golden.width == 640);
  FixedScene fixed;
  const auto renderer = make_renderer(fixed.demo);
  for (const Eigen::Vector3f& step :
       {Eigen::Vector3f(0.01f, 0, 0), Eigen::Vector3f(0, 0.01f, 0), Eigen::Vector3f(0, 0, 0.01f)}) {
    render::View view = fixed.view;
    view.camera.eye += step;
    const auto comparison =
        compare(draw(*renderer, fixed.demo.scene, view), golden, another_rasteriser);
    INFO(comparison);
    CHECK(!comparison.matches);
  }
}

TEST_CASE("The comparison fails when a stripe is blank") {
  if (updating()) return;
  const Image golden = golden_image("playground");
  REQUIRE(golden.width == 640);
  Image striped = golden;
  const std::size_t row_bytes = 3 * 640;
  const auto row = striped.rgb.begin() + static_cast<std::ptrdiff_t>(200 * row_bytes);
  std::fill(row, row + static_cast<std::ptrdiff_t>(row_bytes), std::uint8_t{0});
  const auto comparison = compare(striped, golden, another_rasteriser);
  INFO(comparison);
  CHECK(!comparison.matches);
  CHECK(comparison.failing_fraction == Approx(1.0 / 360));
}

TEST_CASE("Images of different sizes never match, nor does an empty one") {
  const Tolerance anything{255, 1, 255};
  const Image small{2, 1, std::vector<std::uint8_t>(6)}, large{2, 2, std::vector<std::uint8_t>(12)};
  CHECK(compare(small, small, anything));
  CHECK(!compare(small, large, anything).matches);
  CHECK(!compare(Image{}, Image{}, anything).matches);
}

TEST_CASE("A comparison measures maximum, mean and failing fraction") {
  Image a{4, 1, std::vector<std::uint8_t>(12, 100)}, b = a;
  b.rgb[0] = 112;
  b.rgb[4] = 99;
  const auto comparison = compare(a, b, {1, 0.25, 13.0 / 12});
  CHECK(comparison.matches);
  CHECK(comparison.maximum_difference == 12);
  CHECK(comparison.mean_difference == Approx(13.0 / 12));
  CHECK(comparison.failing_fraction == Approx(0.25));
  CHECK(!compare(a, b, {1, 0.24, 2}).matches);
  CHECK(!compare(a, b, {1, 0.25, 1.0}).matches);
}

}  // namespace aureole::test
