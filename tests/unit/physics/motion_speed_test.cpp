// How fast a body moves, against points of its surface one by one.
#include <random>

#include "server/physics/shape.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

/// Points of the surface, in the shape's own frame.
std::vector<Eigen::Vector3f> points_of(const Shape& shape, std::mt19937& random) {
  std::normal_distribution<float> normal;
  std::vector<Eigen::Vector3f> points;
  for (int n = 0; n < 2000; ++n) {
    const Eigen::Vector3f ray = Eigen::Vector3f(normal(random), normal(random), normal(random));
    const Eigen::Vector3f unit = ray.normalized();
    if (const auto* sphere = std::get_if<SphereShape>(&shape))
      points.push_back(sphere->radius * unit);
    else if (const auto* box = std::get_if<BoxShape>(&shape))
      points.push_back(unit.cwiseSign().cwiseProduct(box->half_extents));
    else if (const auto* capsule = std::get_if<CapsuleShape>(&shape))
      points.push_back(
          capsule->radius * unit +
          Eigen::Vector3f(0, std::copysign(capsule->height / 2 - capsule->radius, unit.y()), 0));
    else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
      const Eigen::Vector2f rim = Eigen::Vector2f(ray.x(), ray.z()).normalized() * cylinder->radius;
      points.emplace_back(rim.x(), std::copysign(cylinder->height / 2, unit.y()), rim.y());
    }
  }
  return points;
}

}  // namespace

TEST_CASE("nothing of a shape gets anywhere faster than it says, and something nearly as fast") {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (const Shape& shape : {Shape{SphereShape{0.3f}}, Shape{BoxShape{{0.15f, 0.5f, 0.2f}}},
                             Shape{CapsuleShape{0.3f, 2}}, Shape{CylinderShape{0.4f, 1.2f}}}) {
    const auto points = points_of(shape, random);
    for (int n = 0; n < 200; ++n) {
      const Eigen::Quaternionf turned =
          Eigen::Quaternionf(normal(random), normal(random), normal(random), normal(random))
              .normalized();
      const Eigen::Vector3f velocity(normal(random), normal(random), normal(random));
      const Eigen::Vector3f spin(normal(random), normal(random), normal(random));
      // Turning about an axis of symmetry moves nothing out of its place.
      const Eigen::Vector3f axis = turned * Eigen::Vector3f::UnitY();
      Eigen::Vector3f idle(0, 0, 0);
      if (std::holds_alternative<SphereShape>(shape)) idle = spin;
      if (std::holds_alternative<CapsuleShape>(shape) ||
          std::holds_alternative<CylinderShape>(shape))
        idle = spin.dot(axis) * axis;
      float fastest = 0;
      for (const Eigen::Vector3f& point : points)
        fastest = std::max(fastest, (velocity + (spin - idle).cross(turned * point)).norm());
      const float said = motion_speed(shape, turned, velocity, spin);
      REQUIRE(said >= fastest * 0.999f);
      REQUIRE(said <= fastest * 1.6f + 0.4f * idle.norm());
      // … but what it could become counts.
      if (idle.norm() > 0.1f) REQUIRE(said > motion_speed(shape, turned, velocity, spin - idle));
    }
  }
}

TEST_CASE("all the energy of a ball that rolls would not make it faster than it says") {
  const float v = 3, r = 0.3f;  // It rolls at v: ω = v / r.
  const float said = motion_speed(Shape{SphereShape{r}}, Eigen::Quaternionf::Identity(), {v, 0, 0},
                                  {0, 0, -v / r});
  REQUIRE(said * said == Approx(v * v + 0.4f * v * v));
}

TEST_CASE("a capsule that rolls is slower than one that tumbles as fast") {
  const Shape capsule = CapsuleShape{0.3f, 2};
  const Eigen::Vector3f still{0, 0, 0};
  const auto upright = Eigen::Quaternionf::Identity();
  REQUIRE(motion_speed(capsule, upright, still, {0, 1, 0}) == Approx(std::sqrt(0.5f) * 0.3f));
  REQUIRE(motion_speed(capsule, upright, still, {1, 0, 0}) == Approx(1.0f));
}
