// Poses in few bits, on one grid for the whole world, so that every server quantises a body alike.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "server/base/world_position.h"

namespace aureole {

/// Edge of a grid cell (unit: m). A power of two, so that grid points are exact floats.
inline constexpr double position_grid_m = 1.0 / 1024.0;
/// Worlds reach at most this far from the origin along each axis (unit: m): ±2^23 cells.
inline constexpr double position_limit_m = 8192.0;
/// Largest distance along one axis between a position and its quantised one (unit: m).
inline constexpr double position_error_m = position_grid_m / 2;
/// Largest angle between an orientation and its quantised one (unit: rad); checked by a test.
inline constexpr double orientation_error_rad = 1.1e-4;

using QuantisedPosition = std::array<std::uint8_t, 9>;
using QuantisedOrientation = std::array<std::uint8_t, 6>;

/// Nearest grid point; positions outside the limits are clamped to them.
QuantisedPosition quantise(const WorldPosition& position);
WorldPosition dequantise(const QuantisedPosition& q);

/// "Smallest three": the largest component is left out and has its sign made positive; 15 bits for
/// each of the others. Source: Glenn Fiedler, "Snapshot Compression", 2015.
QuantisedOrientation quantise(const Eigen::Quaternionf& orientation);
Eigen::Quaternionf dequantise(const QuantisedOrientation& q);

}  // namespace aureole
