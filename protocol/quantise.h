// Poses in few bits, on one grid for the whole world, so that every server quantises a body alike.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

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
QuantisedPosition quantise(const WorldPosition& position);
WorldPosition dequantise(const QuantisedPosition& q);

/// "Smallest three": the largest component is left out and has its sign made positive; 15 bits for
/// each of the others. Source: Glenn Fiedler, "Snapshot Compression", 2015.
/// Uses 47 bits. What quantise() returns comes back unchanged from quantise(dequantise(q)). A
/// quaternion without a direction (zero, NaN, infinite) becomes the identity. dequantise() takes
/// any bits and returns a unit quaternion.
std::uint64_t orientation_bits(const Eigen::Quaternionf& orientation);
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

}  // namespace aureole
