// Poses in few bits: 24 bits an axis, and the smallest three components of a quaternion.
#include "protocol/quantise.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace aureole {
namespace {

constexpr int component_bits = 15;
constexpr std::int32_t component_max = (1 << component_bits) - 2;  // even: zero has its own code
constexpr std::int32_t component_zero = component_max / 2;
constexpr double component_limit = 0.70710678118654752;  // 1/√2
/// A sum of squares that is so near to one has its root from one step of Newton's method.
constexpr double near_one = 1e-6;
/// In steps of a component, the square of the unit sphere's radius.
constexpr double radius_squared = 2.0 * component_zero * component_zero;

/// As std::nearbyint() has it, but without a call. Requires |value| < 2^51.
double nearest(double value) {
  return (value + no_fractions) - no_fractions;
}

/// A quaternion in codes, not packed yet.
struct SmallestThree {
  int largest = 3;
  std::array<std::int32_t, 3> codes{component_zero, component_zero, component_zero};
};

Eigen::Vector4f unpack(const SmallestThree& q) {
  Eigen::Vector4d c;
  double rest = 1;
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i == q.largest) continue;
    c[i] = (q.codes[k++] - component_zero) * (component_limit / component_zero);
    rest -= c[i] * c[i];
  }
  // Codes that no orientation has (only garbage from outside) can add up to more than one.
  c[q.largest] = std::sqrt(std::max(rest, 0.0));
  if (rest < 0) c.normalize();
  return c.cast<float>();
}

/// The first of those that are equal. Which one it is nobody can foretell: no branches. Without its
/// sign, a float that is a number is as large as its bits are.
int index_of_largest(const Eigen::Vector4f& c) {
  const auto key = [&](int i) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(std::abs(c[i]))} << 2 |
           static_cast<std::uint64_t>(3 - i);
  };
  const std::uint64_t largest = std::max(std::max(key(0), key(1)), std::max(key(2), key(3)));
  return 3 - static_cast<int>(largest & 3);
}

/// 1/√squared for what is positive. Orientations are of length one but for what floats lose; there
/// one step of Newton's method from one is off by less than 4e-13, and nobody waits for a root.
double inverse_root(double squared) {
  return std::abs(squared - 1) < near_one ? 1.5 - 0.5 * squared : 1 / std::sqrt(squared);
}

/// The components that are not left out, in order.
constexpr int others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/// Whether the component that was left out is still the largest after rounding, so that quantising
/// the unpacked quaternion leaves out the same one.
bool is_stable(const SmallestThree& q) {
  return index_of_largest(unpack(q)) == q.largest;
}

/// Rounding away from zero makes the component that was left out smaller than the others where they
/// were nearly equal. Rounding all three towards zero can only make it larger; if even then another
/// one is its equal, that one gives up a step.
void make_stable(SmallestThree& q, const std::array<double, 3>& exact) {
  for (int k = 0; k < 3; ++k)
    q.codes[k] = component_zero + static_cast<std::int32_t>(std::trunc(exact[k]));
  if (is_stable(q)) return;
  const Eigen::Vector4f c = unpack(q);
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i == q.largest) continue;
    if (std::abs(c[i]) >= c[q.largest]) q.codes[k] += c[i] > 0 ? -1 : 1;
    ++k;
  }
}

#ifdef __SSE2__

__m128 choose(__m128 mask, __m128 chosen, __m128 otherwise) {
  return _mm_or_ps(_mm_and_ps(mask, chosen), _mm_andnot_ps(mask, otherwise));
}

/// Doubles of four orientations, two in each half.
struct Four {
  __m128d first, second;

  static Four of(__m128 floats) {
    return {_mm_cvtps_pd(floats), _mm_cvtps_pd(_mm_movehl_ps(floats, floats))};
  }
  static Four all(double value) { return {_mm_set1_pd(value), _mm_set1_pd(value)}; }
  friend Four operator+(Four a, Four b) {
    return {_mm_add_pd(a.first, b.first), _mm_add_pd(a.second, b.second)};
  }
  friend Four operator-(Four a, Four b) {
    return {_mm_sub_pd(a.first, b.first), _mm_sub_pd(a.second, b.second)};
  }
  friend Four operator*(Four a, Four b) {
    return {_mm_mul_pd(a.first, b.first), _mm_mul_pd(a.second, b.second)};
  }
  /// Masks of four floats.
  friend __m128 operator<(Four a, Four b) {
    return _mm_shuffle_ps(_mm_castpd_ps(_mm_cmplt_pd(a.first, b.first)),
                          _mm_castpd_ps(_mm_cmplt_pd(a.second, b.second)), 0b10'00'10'00);
  }
  /// The lower half of each one's bits.
  __m128i low_bits() const {
    return _mm_castps_si128(
        _mm_shuffle_ps(_mm_castpd_ps(first), _mm_castpd_ps(second), 0b10'00'10'00));
  }
};

/// Does what orientation_bits() does, step by step, for those of four that are of length one and
/// whose largest component no rounding can make smaller than another one: nearly all. One bit for
/// each that is done.
unsigned usual_orientation_bits(const std::array<const Eigen::Quaternionf*, 4>& orientations,
                                std::array<std::uint64_t, 4>& bits) {
  __m128 c[4];  // One component of all four each.
  for (std::size_t n = 0; n < 4; ++n) c[n] = _mm_loadu_ps(orientations[n]->coeffs().data());
  _MM_TRANSPOSE4_PS(c[0], c[1], c[2], c[3]);

  std::array<Four, 4> squared;
  for (std::size_t i = 0; i < 4; ++i) squared[i] = Four::of(c[i]) * Four::of(c[i]);
  const Four squared_norm = (squared[0] + squared[1]) + (squared[2] + squared[3]);
  const Four off = squared_norm - Four::all(1);
  const __m128 is_unit = _mm_and_ps(off < Four::all(near_one), Four::all(-near_one) < off);

  const __m128 sign = _mm_set1_ps(-0.f);
  const auto size = [&](std::size_t i) { return _mm_andnot_ps(sign, c[i]); };
  const __m128 largest_size =
      _mm_max_ps(_mm_max_ps(size(0), size(1)), _mm_max_ps(size(2), size(3)));
  // Whether the largest is the first component, among the first two, or among the first three.
  const __m128 in_1 = _mm_cmpeq_ps(size(0), largest_size);
  const __m128 in_2 = _mm_or_ps(in_1, _mm_cmpeq_ps(size(1), largest_size));
  const __m128 in_3 = _mm_or_ps(in_2, _mm_cmpeq_ps(size(2), largest_size));
  const __m128 largest = choose(in_1, c[0], choose(in_2, c[1], choose(in_3, c[2], c[3])));
  const __m128 flipped = _mm_and_ps(sign, largest);
  const __m128 others_of[3] = {choose(in_1, c[1], c[0]), choose(in_2, c[2], c[1]),
                               choose(in_3, c[3], c[2])};

  const Four scale = (Four::all(1.5) - Four::all(0.5) * squared_norm) *
                     Four::all(component_zero / component_limit);
  __m128i codes[3];
  __m128 squares = _mm_setzero_ps(), second = _mm_setzero_ps();
  for (std::size_t k = 0; k < 3; ++k) {
    const Four exact = Four::of(_mm_xor_ps(others_of[k], flipped)) * scale;
    const __m128i rounded = (exact + Four::all(no_fractions)).low_bits();
    codes[k] = _mm_add_epi32(rounded, _mm_set1_epi32(component_zero));
    const __m128 steps = _mm_cvtepi32_ps(rounded);
    squares = _mm_add_ps(squares, _mm_mul_ps(steps, steps));
    second = _mm_max_ps(second, _mm_andnot_ps(sign, steps));
  }
  const __m128 limit = _mm_add_ps(second, _mm_set1_ps(1));
  const __m128 is_apart =
      _mm_cmpge_ps(_mm_sub_ps(_mm_set1_ps(radius_squared), squares), _mm_mul_ps(limit, limit));

  // Masks are minus one: three less one for each.
  const __m128i index =
      _mm_add_epi32(_mm_add_epi32(_mm_set1_epi32(3), _mm_castps_si128(in_1)),
                    _mm_add_epi32(_mm_castps_si128(in_2), _mm_castps_si128(in_3)));
  const __m128i low = _mm_or_si128(
      index,
      _mm_or_si128(_mm_slli_epi32(codes[0], 2), _mm_slli_epi32(codes[1], 2 + component_bits)));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(&bits[0]), _mm_unpacklo_epi32(low, codes[2]));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(&bits[2]), _mm_unpackhi_epi32(low, codes[2]));
  return static_cast<unsigned>(_mm_movemask_ps(_mm_and_ps(is_unit, is_apart)));
}

#else

/// Other processors do all of them one by one.
unsigned usual_orientation_bits(const std::array<const Eigen::Quaternionf*, 4>&,
                                std::array<std::uint64_t, 4>&) {
  return 0;
}

#endif

}  // namespace

WorldPosition dequantise(const QuantisedPosition& q) {
  double metres[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t bits = 0;
    for (int byte = 0; byte < 3; ++byte) bits |= std::uint32_t{q[axis * 3 + byte]} << (8 * byte);
    // The sign bit is bit 23: shifting up and back down (arithmetically) extends it.
    metres[axis] = (static_cast<std::int32_t>(bits << 8) >> 8) * position_grid_m;
  }
  return {metres[0], metres[1], metres[2]};
}

std::uint64_t orientation_bits(const Eigen::Quaternionf& orientation) {
  SmallestThree packed;
  const Eigen::Vector4d coefficients = orientation.coeffs().cast<double>();
  const Eigen::Array4d squared = coefficients.array().square();
  const double squared_norm = (squared[0] + squared[1]) + (squared[2] + squared[3]);
  if (std::isfinite(squared_norm) && squared_norm > 0) {
    packed.largest = index_of_largest(orientation.coeffs());
    const double scale =
        std::copysign(inverse_root(squared_norm) * (component_zero / component_limit),
                      coefficients[packed.largest]);
    std::array<double, 3> exact{};
    double squares = 0;
    double second = 0;
    for (int k = 0; k < 3; ++k) {
      const double component = coefficients[others[packed.largest][k]];
      exact[k] =
          std::max(std::min(component * scale, double{component_zero}), -double{component_zero});
      const double rounded = nearest(exact[k]);
      packed.codes[k] = component_zero + static_cast<std::int32_t>(rounded);
      squares += rounded * rounded;
      second = std::max(second, std::abs(rounded));
    }
    // The first condition spares nearly all orientations the second one. One step of distance is
    // far more than floats lose.
    if (radius_squared - squares < (second + 1) * (second + 1) && !is_stable(packed))
      make_stable(packed, exact);
  }

  std::uint64_t bits = static_cast<std::uint64_t>(packed.largest);
  for (int k = 0; k < 3; ++k)
    bits |= static_cast<std::uint64_t>(packed.codes[k]) << (2 + k * component_bits);
  return bits;
}

std::array<std::uint64_t, 4> orientation_bits(
    const std::array<const Eigen::Quaternionf*, 4>& orientations) {
  std::array<std::uint64_t, 4> bits{};
  const unsigned done = usual_orientation_bits(orientations, bits);
  for (std::size_t n = 0; n < bits.size(); ++n)
    if ((done >> n & 1) == 0) bits[n] = orientation_bits(*orientations[n]);
  return bits;
}

Eigen::Quaternionf dequantise(const QuantisedOrientation& q) {
  std::uint64_t bits = 0;
  for (int byte = 0; byte < 6; ++byte) bits |= std::uint64_t{q[byte]} << (8 * byte);
  SmallestThree packed;
  packed.largest = static_cast<int>(bits & 3);
  for (int k = 0; k < 3; ++k) {
    const auto code = (bits >> (2 + k * component_bits)) & ((1u << component_bits) - 1);
    packed.codes[k] = std::min(static_cast<std::int32_t>(code), component_max);
  }
  return Eigen::Quaternionf(unpack(packed));
}

}  // namespace aureole
