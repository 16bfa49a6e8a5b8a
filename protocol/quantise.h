// Poses in few bits, on one grid for the whole world, so that every server quantises a body alike.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <tuple>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "server/base/world_position.h"

namespace aureole {

/// Edge of a grid cell (unit: m). A power of two, so that grid points are exact floats.
inline constexpr double position_grid_m = 1.0 / 1024.0;
/// Worlds reach at most this far from the origin along each axis (unit: m): ±2^23 cells. The last
/// cell on the positive side has no code of its own: 8192 m itself comes back as 8192 m less one
/// cell.
inline constexpr double position_limit_m = 8192.0;
/// Largest distance along one axis between a position and its quantised one (unit: m).
inline constexpr double position_error_m = position_grid_m / 2;
/// Largest angle between an orientation and its quantised one (unit: rad); checked by a test. With
/// h half a step of a component (1/√2 / 32766), rounding moves three components by at most h and
/// the fourth, which is worked out from them, by at most 3 h, so the angle is at most 2 √12 h
/// = 1.495e-4. Where two components are nearly the largest, quantise() may have to round towards
/// zero instead (see quantise.cpp), which doubles it: 2.99e-4.
inline constexpr double orientation_error_rad = 3.0e-4;

using QuantisedPosition = std::array<std::uint8_t, 9>;
using QuantisedOrientation = std::array<std::uint8_t, 6>;

/// Nearest grid point; positions outside the limits are clamped to them, NaN becomes 0.
inline QuantisedPosition quantise(const WorldPosition& position);
WorldPosition dequantise(const QuantisedPosition& q);

/// "Smallest three": the largest component is left out and has its sign made positive; 15 bits for
/// each of the others. Source: Glenn Fiedler, "Snapshot Compression", 2015.
/// Uses 47 bits. What quantise() returns comes back unchanged from quantise(dequantise(q)). A
/// quaternion without a direction (zero, NaN, infinite) becomes the identity. dequantise() takes
/// any bits and returns a unit quaternion.
std::uint64_t orientation_bits(const Eigen::Quaternionf& orientation);
/// The same of four at once, which takes hardly longer than of one.
std::array<std::uint64_t, 4> orientation_bits(
    const std::array<const Eigen::Quaternionf*, 4>& orientations);
/// The same in six bytes, the lowest one first. Inline: GCC returns six bytes one by one, and who
/// reads them at once then has to wait.
inline QuantisedOrientation quantise(const Eigen::Quaternionf& orientation) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t bits = orientation_bits(orientation);
  QuantisedOrientation q;
  std::memcpy(q.data(), &bits, q.size());
  return q;
}
Eigen::Quaternionf dequantise(const QuantisedOrientation& q);

/// Past 2^52 doubles have no digits behind the point: adding so much rounds to the nearest whole
/// number, of two the even one, and leaves it in the lowest bits.
inline constexpr double no_fractions = 0x1.8p52;

/// The nearest cells along the axes as 24 bits each, with what positions outside the limits and NaN
/// become as in quantise().
inline std::array<std::uint64_t, 3> cell_bits(const WorldPosition& position) {
  constexpr double cells_max = (1 << 23) - 1, cells_min = -cells_max - 1;
  std::array<std::uint64_t, 3> bits;
#ifdef __SSE2__
  // x and y at once; all poses that a server tells of go through here in every tick.
  const auto rounded = [&](__m128d metres) {
    const __m128d cells = _mm_mul_pd(metres, _mm_set1_pd(1 / position_grid_m));
    const __m128d number = _mm_and_pd(cells, _mm_cmpord_pd(cells, cells));
    const __m128d inside =
        _mm_min_pd(_mm_max_pd(number, _mm_set1_pd(cells_min)), _mm_set1_pd(cells_max));
    return _mm_castpd_si128(_mm_add_pd(inside, _mm_set1_pd(no_fractions)));
  };
  const __m128i xy = rounded(_mm_loadu_pd(&position.x)), z = rounded(_mm_load_sd(&position.z));
  bits = {static_cast<std::uint64_t>(_mm_cvtsi128_si64(xy)),
          static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_unpackhi_epi64(xy, xy))),
          static_cast<std::uint64_t>(_mm_cvtsi128_si64(z))};
#else
  const auto rounded = [&](double metres) {
    const double cells = std::isnan(metres) ? 0 : metres / position_grid_m;
    return std::bit_cast<std::uint64_t>(std::clamp(cells, cells_min, cells_max) + no_fractions);
  };
  bits = {rounded(position.x), rounded(position.y), rounded(position.z)};
#endif
  for (std::uint64_t& axis : bits) axis &= 0xffffff;
  return bits;
}

/// A whole pose, held so that two are compared, and one is copied, without going through its bytes.
class QuantisedPose {
 public:
  /// How many bytes it has: those of the position, then those of the orientation.
  static constexpr std::size_t size =
      std::tuple_size_v<QuantisedPosition> + std::tuple_size_v<QuantisedOrientation>;

  QuantisedPose() = default;
  /// `orientation`: from orientation_bits().
  QuantisedPose(const WorldPosition& position, std::uint64_t orientation) {
    const auto [x, y, z] = cell_bits(position);
    low_ = x | y << 24 | z << 48;
    high_ = z >> 16 | orientation << 8;
  }

  /// Its bytes 0 to 7, and 8 to 14, the lowest one first.
  std::uint64_t low() const { return low_; }
  std::uint64_t high() const { return high_; }
  friend bool operator==(const QuantisedPose&, const QuantisedPose&) = default;

 private:
  std::uint64_t low_ = 0, high_ = 0;
};

inline QuantisedPosition quantise(const WorldPosition& position) {
  static_assert(std::endian::native == std::endian::little);
  const QuantisedPose pose(position, 0);
  QuantisedPosition q;
  const std::uint64_t low = pose.low();
  std::memcpy(q.data(), &low, sizeof low);
  q.back() = static_cast<std::uint8_t>(pose.high());
  return q;
}

}  // namespace aureole
