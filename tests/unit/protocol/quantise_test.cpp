// Quantised poses: the stated error bounds hold, and what has been quantised once does not change.
#include "protocol/quantise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>

#include "protocol/wire_values.h"
#include "tests/support/catch.h"

using namespace aureole;

namespace {

constexpr double nan_d = std::numeric_limits<double>::quiet_NaN();
constexpr double inf_d = std::numeric_limits<double>::infinity();
constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();

/// Angle of the rotation between two orientations (rad). Through the chord, as the arc cosine of
/// the dot product cannot resolve small angles.
double angle_between(const Eigen::Quaternionf& a, const Eigen::Quaternionf& b) {
  const Eigen::Vector4d u = a.coeffs().cast<double>().normalized();
  Eigen::Vector4d v = b.coeffs().cast<double>().normalized();
  if (u.dot(v) < 0) v = -v;
  return 4 * std::asin((u - v).norm() / 2);
}

WorldPosition round_trip(const WorldPosition& p) {
  return dequantise(quantise(p));
}

/// Worst angle over a million orientations; each must come back unchanged when quantised again.
template <class Make>
double worst_angle(Make make) {
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Eigen::Quaternionf o = make();
    const QuantisedOrientation q = quantise(o);
    const Eigen::Quaternionf back = dequantise(q);
    worst = std::max(worst, angle_between(o, back));
    if (quantise(back) != q) FAIL("quantised twice differs from once");
    if (std::abs(back.norm() - 1) > 1e-6f) FAIL("not a unit quaternion");
  }
  return worst;
}

}  // namespace

TEST_CASE("No position moves by more than the stated error, and quantising twice changes nothing") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> anywhere(-8191.9, 8191.9);
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const WorldPosition p{anywhere(random), anywhere(random), anywhere(random)};
    const QuantisedPosition q = quantise(p);
    const WorldPosition back = dequantise(q);
    worst =
        std::max({worst, std::abs(back.x - p.x), std::abs(back.y - p.y), std::abs(back.z - p.z)});
    if (quantise(back) != q) FAIL("quantised twice differs from once");
  }
  CHECK(worst <= position_error_m);
  CHECK(worst > 0.99 * position_error_m);
}

TEST_CASE("Points of the grid are kept exactly, up to both limits, and are exact floats") {
  for (const double cells : {0.0, 1.0, -1.0, 1023.0, -8388608.0, 8388607.0, 4194303.0}) {
    const double metres = cells * position_grid_m;
    CHECK(round_trip({metres, 0, -1}).x == metres);
    CHECK(round_trip({0, metres, 1}).y == metres);
    CHECK(round_trip({3, 0, metres}).z == metres);
    CHECK(double{static_cast<float>(metres)} == metres);
  }
}

TEST_CASE("The axes of a position are kept apart") {
  CHECK(round_trip({1, -2, 3}) == WorldPosition{1, -2, 3});
}

TEST_CASE("Positions outside the world are clamped to its edge, also infinite ones") {
  const double top = position_limit_m - position_grid_m;
  CHECK(round_trip({9000, -9000, 8192}) == WorldPosition{top, -position_limit_m, top});
  CHECK(round_trip({inf_d, -inf_d, 1e300}) == WorldPosition{top, -position_limit_m, top});
}

TEST_CASE("A coordinate that is not a number becomes 0") {
  CHECK(round_trip({nan_d, 2, nan_d}) == WorldPosition{0, 2, 0});
}

TEST_CASE("No orientation with one largest component turns by more than one rounding allows") {
  std::mt19937_64 random(2);
  std::normal_distribution<float> normal;
  const double worst = worst_angle([&] {
    while (true) {
      Eigen::Vector4f c(normal(random), normal(random), normal(random), normal(random));
      c.normalize();
      std::array<float, 4> sizes{std::abs(c[0]), std::abs(c[1]), std::abs(c[2]), std::abs(c[3])};
      std::sort(sizes.begin(), sizes.end());
      if (sizes[3] - sizes[2] > 1e-4f) return Eigen::Quaternionf(c);
    }
  });
  // 2 √12 h, reached where all four components are equal; see quantise.h.
  CHECK(worst <= 1.4953e-4);
  CHECK(worst > 1.2e-4);
}

TEST_CASE("Where the largest components are nearly equal the stated error holds as well") {
  std::mt19937_64 random(3);
  std::normal_distribution<float> normal;
  const auto sign = [&] { return random() % 2 ? 1.0f : -1.0f; };
  const float near = 5e-5f;
  SECTION("four of them") {
    const double worst = worst_angle([&] {
      Eigen::Vector4f c;
      for (float& x : c) x = sign() * (0.5f + near * normal(random));
      return Eigen::Quaternionf(c).normalized();
    });
    CHECK(worst <= orientation_error_rad);
  }
  SECTION("three of them") {
    const double worst = worst_angle([&] {
      Eigen::Vector4f c;
      for (float& x : c) x = sign() * (0.57735f + near * normal(random));
      c[static_cast<int>(random() % 4)] = near * normal(random);
      return Eigen::Quaternionf(c).normalized();
    });
    CHECK(worst <= orientation_error_rad);
  }
  SECTION("two of them") {
    const double worst = worst_angle([&] {
      Eigen::Vector4f c;
      for (float& x : c) x = near * normal(random);
      const int first = static_cast<int>(random() % 4);
      c[first] = sign() * (0.7071f + near * normal(random));
      c[(first + 1 + static_cast<int>(random() % 3)) % 4] =
          sign() * (0.7071f + near * normal(random));
      return Eigen::Quaternionf(c).normalized();
    });
    CHECK(worst <= orientation_error_rad);
  }
}

TEST_CASE("The identity and half turns about the axes are exact, under both signs") {
  for (int axis = 0; axis < 4; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      Eigen::Vector4f c = Eigen::Vector4f::Zero();
      c[axis] = sign;
      CHECK(dequantise(quantise(Eigen::Quaternionf(c))).coeffs() == Eigen::Vector4f(sign * c));
    }
}

/// The layout of quantise.h read back: which component was left out, and the others' codes.
std::array<int, 4> codes_of(const QuantisedOrientation& q) {
  std::uint64_t bits = 0;
  for (std::size_t byte = q.size(); byte-- > 0;) bits = bits << 8 | q[byte];
  const auto code = [&](int k) { return static_cast<int>(bits >> (2 + 15 * k) & 0x7fff); };
  return {static_cast<int>(bits & 3), code(0), code(1), code(2)};
}

/// The same by the definition, with long doubles; nothing where the largest two are near to each
/// other or a component is near to half a step, where the last digit of a length decides.
std::optional<std::array<int, 4>> exact_codes(const Eigen::Vector4f& c) {
  constexpr long double zero = 16383;
  long double squares = 0;
  int largest = 0;
  for (int i = 0; i < 4; ++i) {
    squares += static_cast<long double>(c[i]) * static_cast<long double>(c[i]);
    if (std::abs(c[i]) > std::abs(c[largest])) largest = i;
  }
  const long double steps =
      zero * std::sqrt(2.0L / squares) * (std::signbit(c[largest]) ? -1.0L : 1.0L);
  std::array<int, 4> codes{largest, 0, 0, 0};
  for (int i = 0, k = 1; i < 4; ++i) {
    if (i == largest) continue;
    const long double exact = static_cast<long double>(c[i]) * steps;
    const long double largest_exact = static_cast<long double>(c[largest]) * steps;
    if (largest_exact - std::abs(exact) < 4) return std::nullopt;
    if (std::abs(exact - std::floor(exact) - 0.5L) < 1e-5L) return std::nullopt;
    codes[static_cast<std::size_t>(k++)] = static_cast<int>(std::round(exact) + zero);
  }
  return codes;
}

TEST_CASE("Codes are those of exact arithmetic, however long the quaternion is") {
  // Squares inside, at the edge of and outside what is taken for a length of one; far outside.
  const float length = GENERATE(1.f, 1 + 3e-7f, 1 - 3e-7f, 1 + 6e-7f, 1 - 6e-7f, 1 + 1e-5f,
                                1 - 1e-5f, 1.01f, 0.99f, 0.5f, 3.f, 1e-15f, 1e15f);
  CAPTURE(length);
  std::mt19937_64 random(8);
  std::normal_distribution<float> normal;
  int compared = 0;
  for (int n = 0; n < 20'000; ++n) {
    Eigen::Vector4f c(normal(random), normal(random), normal(random), normal(random));
    c *= length / c.norm();
    const auto exact = exact_codes(c);
    if (!exact) continue;
    ++compared;
    REQUIRE(codes_of(quantise(Eigen::Quaternionf(c))) == *exact);
  }
  CHECK(compared > 19'000);
}

TEST_CASE(
    "Of components that are equally large the first is left out, with its sign made positive") {
  CHECK(codes_of(quantise(Eigen::Quaternionf(-1, -0.f, 0, -0.f))) ==
        std::array<int, 4>{3, 16383, 16383, 16383});
  CHECK(codes_of(quantise(Eigen::Quaternionf(0.5f, 0.5f, 0.5f, 0.5f)))[0] == 0);
  CHECK(codes_of(quantise(Eigen::Quaternionf(0.5f, -0.5f, 0.5f, 0.5f)))[0] == 0);
  CHECK(codes_of(quantise(Eigen::Quaternionf(0.70710678f, 0, 0.70710678f, 0)))[0] == 1);
}

TEST_CASE("Equal components come back equal: quarter turns and the turns of a cube") {
  const float half = 0.5f;
  const Eigen::Quaternionf cube(half, -half, half, -half);
  CHECK(angle_between(dequantise(quantise(cube)), cube) <= orientation_error_rad);
  const Eigen::Quaternionf quarter(Eigen::AngleAxisf(1.57079633f, Eigen::Vector3f::UnitY()));
  const Eigen::Quaternionf back = dequantise(quantise(quarter));
  CHECK(angle_between(back, quarter) < 1e-6);
  CHECK(back.x() == 0);
  CHECK(back.z() == 0);
}

TEST_CASE("The length of a quaternion does not matter, and one without direction is the identity") {
  const Eigen::Quaternionf o(0.1f, -0.7f, 0.3f, 0.2f);
  CHECK(quantise(Eigen::Quaternionf(o.coeffs() * 1024)) == quantise(o));
  const QuantisedOrientation identity = quantise(Eigen::Quaternionf::Identity());
  CHECK(dequantise(identity).coeffs() == Eigen::Quaternionf::Identity().coeffs());
  CHECK(quantise(Eigen::Quaternionf(0, 0, 0, 0)) == identity);
  CHECK(quantise(Eigen::Quaternionf(1, nan_f, 0, 0)) == identity);
  CHECK(quantise(Eigen::Quaternionf(1, 0, static_cast<float>(inf_d), 0)) == identity);
}

TEST_CASE("Four orientations at once have the codes that each has by itself") {
  std::mt19937_64 random(5);
  std::normal_distribution<float> normal;
  const auto any = [&] {
    return Eigen::Vector4f(normal(random), normal(random), normal(random), normal(random));
  };
  const float near = 5e-5f;
  const auto make = [&](int n) -> Eigen::Quaternionf {
    Eigen::Vector4f c = any().normalized();
    switch (n % 8) {
      case 0:
        c = Eigen::Vector4f(0.5f, -0.5f, 0.5f, 0.5f) + near * any();
        break;
      case 1:
        c = Eigen::Vector4f(0.70710678f, 0, 0, 0.70710678f) + near * any();
        break;
      case 2:
        c = Eigen::Vector4f(0, -0.70710678f, 0.70710678f, 0);
        break;
      case 3:
        c *= 1 + 1e-6f * normal(random);
        break;
      case 4:
        c *= 3;
        break;
      case 5:
        c[static_cast<int>(random() % 4)] = random() % 2 ? nan_f : static_cast<float>(inf_d);
        break;
      default:
        break;
    }
    return Eigen::Quaternionf(c);
  };
  for (int round = 0; round < 100'000; ++round) {
    std::array<Eigen::Quaternionf, 4> four;
    // All of one kind, and all kinds beside each other.
    for (auto& q : four) q = make(round % 9 < 8 ? round % 9 : static_cast<int>(random() % 8));
    const auto bits = orientation_bits({&four[0], &four[1], &four[2], &four[3]});
    for (std::size_t n = 0; n < 4; ++n)
      if (bits[n] != orientation_bits(four[n]))
        FAIL("the code of " << four[n].coeffs() << " differs");
  }
}

TEST_CASE("A motion is its slot, its position and its orientation, the lowest byte of each first") {
  std::mt19937_64 random(6);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> anywhere(-8191.9, 8191.9);
  for (int n = 0; n < 1000; ++n) {
    const WorldPosition at{anywhere(random), anywhere(random), anywhere(random)};
    const Eigen::Quaternionf turned =
        Eigen::Quaternionf(
            Eigen::Vector4f(normal(random), normal(random), normal(random), normal(random)))
            .normalized();
    const auto slot = static_cast<std::uint32_t>(random() % (1 << 24));
    const wire::ReplicaMotion motion = motion_of(slot, {at, orientation_bits(turned)});
    REQUIRE(slot_of(motion) == slot);
    QuantisedPosition p;
    QuantisedOrientation o;
    std::copy(motion.position()->begin(), motion.position()->end(), p.begin());
    std::copy(motion.orientation()->begin(), motion.orientation()->end(), o.begin());
    REQUIRE(p == quantise(at));
    REQUIRE(o == quantise(turned));
  }
}

TEST_CASE("Any bits are a position inside the world and a unit quaternion") {
  std::mt19937_64 random(4);
  for (int i = 0; i < 200'000; ++i) {
    QuantisedOrientation o;
    QuantisedPosition p;
    for (auto& b : o) b = static_cast<std::uint8_t>(i % 2 ? random() : (random() % 2) * 255);
    for (auto& b : p) b = static_cast<std::uint8_t>(random());
    const float norm = dequantise(o).norm();
    if (!(std::abs(norm - 1) < 1e-6f)) FAIL("length " << norm);
    const WorldPosition at = dequantise(p);
    if (!(at.vector().cwiseAbs().maxCoeff() <= position_limit_m)) FAIL("outside");
    if (quantise(at) != p) FAIL("every position code is a grid point");
  }
}

TEST_CASE("A position halfway between two cells goes to the even one, on either side of zero") {
  for (int cell = -5; cell <= 5; ++cell) {
    const WorldPosition halfway{(cell + 0.5) * position_grid_m, 0, 0};
    const double even = cell % 2 == 0 ? cell : cell + 1;
    CHECK(dequantise(quantise(halfway)).x == even * position_grid_m);
  }
}
