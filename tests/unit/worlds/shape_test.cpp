// Volumes, centres of mass and reach, against closed forms.
#include <numbers>

#include "server/worlds/reading/shape_measure.h"
#include "tests/support/catch.h"

namespace aureole {

TEST_CASE("a box as a hull has the box's volume, points on its faces or inside change nothing") {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(i & 1 ? 3 : 1, i & 2 ? 5 : 2, i & 4 ? 4 : 0);
  const auto box = convex_hull_volume(points);
  REQUIRE(box);
  CHECK(box->volume_m3 == Approx(2 * 3 * 4));
  CHECK((box->centre - Eigen::Vector3d(2, 3.5, 2)).norm() < 1e-9);
  points.insert(points.begin() + 3, {2, 3.5f, 2});
  points.insert(points.begin(), {1, 3, 1});
  points.emplace_back(3, 5, 2);
  points.emplace_back(1, 2, 0);
  const auto same = convex_hull_volume(points);
  REQUIRE(same);
  CHECK(same->volume_m3 == Approx(24));
  CHECK((same->centre - box->centre).norm() < 1e-9);
}

TEST_CASE("64 points on a sphere have nearly its volume, and a pyramid's centre is at a quarter") {
  std::vector<Eigen::Vector3f> ball;
  for (int i = 0; i < 64; ++i) {
    const double y = 1 - (2 * i + 1) / 64.0, a = i * 2.399963, r = std::sqrt(1 - y * y);
    ball.emplace_back(static_cast<float>(r * std::cos(a)), static_cast<float>(y),
                      static_cast<float>(r * std::sin(a)));
  }
  const auto found = convex_hull_volume(ball);
  REQUIRE(found);
  CHECK(found->volume_m3 / (4.0 / 3.0 * std::numbers::pi) > 0.85);
  CHECK(found->volume_m3 / (4.0 / 3.0 * std::numbers::pi) < 1.0);
  CHECK(found->centre.norm() < 0.02);
  const std::vector<Eigen::Vector3f> pyramid = {
      {-1, 0, -1}, {1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {0, 2, 0}};
  CHECK(convex_hull_volume(pyramid)->centre.y() == Approx(0.5));
}

TEST_CASE("points in one plane, on one line or at one place make no hull") {
  CHECK_FALSE(convex_hull_volume(
      std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {2, 0, 5}}));
  CHECK_FALSE(
      convex_hull_volume(std::vector<Eigen::Vector3f>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}));
  CHECK_FALSE(convex_hull_volume(std::vector<Eigen::Vector3f>(5, {1, 2, 3})));
}

TEST_CASE("volumes of the simple shapes follow their formulas") {
  const double pi = std::numbers::pi;
  CHECK(volume_and_centre(SphereShape{0.3f}).volume_m3 == Approx(4.0 / 3 * pi * 0.027));
  CHECK(volume_and_centre(BoxShape{{1, 2, 3}}).volume_m3 == Approx(48));
  CHECK(volume_and_centre(CapsuleShape{0.3f, 2}).volume_m3 ==
        Approx(pi * 0.09 * 1.4 + 4.0 / 3 * pi * 0.027));
  CHECK(volume_and_centre(CylinderShape{0.5f, 2}).volume_m3 == Approx(pi * 0.5));
}

TEST_CASE("reach is exact for turned shapes") {
  const Eigen::Quaternionf lying(
      Eigen::AngleAxisf(static_cast<float>(std::numbers::pi / 2), Eigen::Vector3f::UnitZ()));
  CHECK(reach_of(CapsuleShape{0.3f, 2}, lying).max.x() == Approx(1));
  CHECK(reach_of(CapsuleShape{0.3f, 2}, lying).max.y() == Approx(0.3));
  CHECK(reach_of(CylinderShape{0.5f, 2}, lying).min.y() == Approx(-0.5));
  const Eigen::Quaternionf tilted(
      Eigen::AngleAxisf(static_cast<float>(std::numbers::pi / 4), Eigen::Vector3f::UnitZ()));
  CHECK(reach_of(BoxShape{{1, 1, 1}}, tilted).max.y() == Approx(std::sqrt(2.0)));
  CHECK(reach_of(CylinderShape{1, 2}, tilted).max.y() == Approx(std::sqrt(2.0)));
}

}  // namespace aureole
