// Distances of shapes against closed forms, and who met whom between two ticks.
#include <limits>

#include "server/physics/shape_probe.h"
#include "tests/unit/physics/scenes.h"

using namespace aureole;
using namespace aureole::scenes;

namespace {

constexpr double millimetre = 1e-3;

BodyState at(double x, double y, double z) {
  BodyState s;
  s.position = {x, y, z};
  return s;
}

BodyState turned(BodyState s, float radians, const Eigen::Vector3f& axis) {
  s.orientation = Eigen::AngleAxisf(radians, axis.normalized());
  return s;
}

const float quarter = static_cast<float>(M_PI / 2);

double gap(std::uint16_t a, const BodyState& pose_a, std::uint16_t b, const BodyState& pose_b) {
  const ShapeProbe probe(prototypes());
  const double found = double{probe.separation(PrototypeId{a}, pose_a, PrototypeId{b}, pose_b)};
  const double other = double{probe.separation(PrototypeId{b}, pose_b, PrototypeId{a}, pose_a)};
  CHECK((found == other || std::abs(found - other) < millimetre));
  return found;
}

std::optional<float> meeting(std::uint16_t prototype_a, const BodyState& a_from,
                             const BodyState& a_to, std::uint16_t prototype_b,
                             const BodyState& b_from, const BodyState& b_to, float slop_m = 0.01f) {
  const ShapeProbe probe(prototypes());
  return probe.swept_contact({PrototypeId{prototype_a}, a_from, a_to},
                             {PrototypeId{prototype_b}, b_from, b_to}, slop_m);
}

}  // namespace

TEST_CASE("two balls are as far apart as their centres less their radii") {
  for (double d : {0.3, 0.7, 0.95, 1.0, 1.05, 1.09}) {
    const BodyState a = at(1e5, 3, -7);
    const BodyState b = at(1e5 + d * 0.6, 3, -7 + d * 0.8);
    CHECK(gap(ball, a, ball, b) == Approx(d - 1).margin(millimetre));
  }
  CHECK(gap(ball, at(0, 0, 0), ball, at(1.2, 0, 0)) == std::numeric_limits<double>::infinity());
  CHECK(gap(ball, at(0, 0, 0), ball, at(900, 0, 0)) == std::numeric_limits<double>::infinity());
}

TEST_CASE("two boxes face to face, edge to face and corner to corner") {
  const BodyState a = at(0, 0, 0);
  for (double d : {-0.3, -0.02, -0.002, 0.0, 0.002, 0.05}) {
    CHECK(gap(cube, a, cube, at(0.3, 1 + d, -0.2)) == Approx(d).margin(millimetre));
    // An edge points down: half the diagonal of a face.
    const BodyState edge = turned(at(0.1, 0.5 + std::sqrt(0.5) + d, 0), quarter / 2, {0, 0, 1});
    CHECK(gap(cube, a, cube, edge) == Approx(d).margin(millimetre));
  }
  // Two corners along a diagonal of space: not rounded.
  const double corner = 1 + 0.05 / std::sqrt(3.0);
  CHECK(gap(cube, a, cube, at(corner, corner, corner)) == Approx(0.05).margin(millimetre));
}

TEST_CASE("a capsule that stands or lies on a box") {
  const BodyState box = at(0, 0, 0);
  for (double d : {-0.25, -0.1, -0.01, 0.0, 0.01, 0.08}) {
    CHECK(gap(capsule, at(0.1, 0.5 + 0.6 + d, 0.2), cube, box) == Approx(d).margin(millimetre));
    const BodyState lying = turned(at(0, 0.5 + 0.3 + d, 0), quarter, {0, 0, 1});
    CHECK(gap(capsule, lying, cube, box) == Approx(d).margin(millimetre));
  }
}

TEST_CASE("cylinders, hulls and compounds are measured to their faces") {
  for (double d : {-0.1, -0.01, 0.01, 0.05}) {
    CHECK(gap(cylinder, at(0, 0.4 + 0.5 + d, 0), cube, at(0, 0, 0)) ==
          Approx(d).margin(millimetre));
    CHECK(gap(hull, at(0, 0.4 + 0.5 + d, 0), ball, at(0, 0, 0)) ==
          Approx(d).margin(2 * millimetre));
    CHECK(gap(compound, at(0, 0.45 + 0.5 + d, 0), cube, at(0, 0, 0)) ==
          Approx(d).margin(millimetre));
  }
  // Between the table's legs, 0.8 m apart, there is room for a capsule 0.6 m wide.
  CHECK(gap(compound, at(0, 0, 0), capsule, at(0.04, -0.6, 0)) == Approx(0.06).margin(millimetre));
}

TEST_CASE("the probe agrees with Bullet's contacts in a heap") {
  PhysicsWorld world = world_on_ground();
  world.add(heap(120, 41, 4));
  run(world, 250);
  const ShapeProbe probe(prototypes());
  std::size_t compared = 0;
  for (const ContactManifold& c : world.contacts_within(world.ids())) {
    const BodyId* b = std::get_if<BodyId>(&c.b);
    if (!b) continue;
    float deepest = 1;
    for (const ContactPoint& p : c.points) deepest = std::min(deepest, p.distance);
    const float found = probe.separation(world.prototype(c.a), world.state(c.a),
                                         world.prototype(*b), world.state(*b));
    // The points are a step old, and a compound's manifold is that of one child.
    CHECK(found < deepest + 0.01f);
    CHECK(found > deepest - 0.03f);
    ++compared;
  }
  CHECK(compared > 60);
}

TEST_CASE("no pair of shapes changes its distance by more than it is moved") {
  // Bullet's EPA alone jumps by centimetres in a few of these.
  const ShapeProbe probe(prototypes());
  std::mt19937 random(5);
  const auto between = [&](float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
  };
  const auto any_turn = [&] {
    return Eigen::Quaternionf(between(-1, 1), between(-1, 1), between(-1, 1), between(0.1f, 1))
        .normalized();
  };
  int measured = 0;
  for (int i = 0; i < 6000; ++i) {
    const PrototypeId one{static_cast<std::uint16_t>(random() % kinds)};
    const PrototypeId two{static_cast<std::uint16_t>(random() % kinds)};
    BodyState a = at(0, 0, 0);
    BodyState b = at(double{between(-1, 1)}, double{between(-1, 1)}, double{between(-1, 1)});
    if (random() % 3) a.orientation = any_turn();
    if (random() % 3) b.orientation = any_turn();
    const float before = probe.separation(one, a, two, b);
    b.position.y += millimetre;
    const float after = probe.separation(one, a, two, b);
    if (std::isinf(before) || std::isinf(after)) continue;
    REQUIRE(double{std::abs(after - before)} < 2 * millimetre);
    ++measured;
  }
  CHECK(measured > 3000);
}

TEST_CASE("two fast balls that pass through each other within a tick have met") {
  const auto met = meeting(ball, at(-2, 0, 0), at(2, 0, 0), ball, at(2, 0, 0), at(-2, 0, 0), 0);
  REQUIRE(met);
  // 4 m apart they close 8 m in the tick; they touch after 3 m.
  CHECK(double{*met} == Approx(3.0 / 8).margin(0.01));
  const auto later =
      meeting(ball, at(-2, 0, 0), at(2, 0, 0), ball, at(2, 0, 0), at(-2, 0, 0), 0.2f);
  REQUIRE(later);
  CHECK(double{*later} == Approx(3.2 / 8).margin(0.01));
}

TEST_CASE("two that pass by at a distance, stand or only graze have not met") {
  CHECK(!meeting(ball, at(-2, 0, 0), at(2, 0, 0), ball, at(2, 1.05, 0), at(-2, 1.05, 0)));
  CHECK(!meeting(ball, at(-2, 0, 0), at(2, 0, 0), ball, at(2, 0.995, 0), at(-2, 0.995, 0)));
  CHECK(!meeting(ball, at(0, 0, 0), at(9, 0, 0), ball, at(1.5, 0, 0), at(10.5, 0, 0)));
  CHECK(!meeting(cube, at(0, 0, 0), at(0, 0, 0), cube, at(0, 1, 0), at(0, 1, 0)));
  CHECK(!meeting(cube, at(0, 0, 0), at(1, 0, 0), cube, at(0, 1, 0), at(0, 1, 0)));
  CHECK(!meeting(plank, at(0, 0, 0), at(0, 0, 0), ball, at(-3, 0.8, 0), at(3, 0.8, 0)));
}

TEST_CASE("two that overlap from the start have met at once, and a thin plank is not missed") {
  CHECK(meeting(cube, at(0, 0, 0), at(5, 0, 0), cube, at(0, 0.9, 0), at(0, 9, 0)) == 0.0f);
  CHECK(meeting(cube, at(0, 0, 0), at(0, 0, 0), cube, at(0, 0.9, 0), at(0, 0.9, 0)) == 0.0f);
  const auto met = meeting(plank, at(0, 0, 0), at(0, 0, 0), ball, at(0, 0, 3), at(0, 0, -3));
  REQUIRE(met);
  CHECK(double{*met} == Approx((3 - 0.65 + 0.01) / 6).margin(0.005));
}
