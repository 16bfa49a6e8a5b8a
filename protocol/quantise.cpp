// Poses in few bits: 24 bits an axis, and the smallest three components of a quaternion.
#include "protocol/quantise.h"

#include <algorithm>
#include <cmath>

namespace aureole {
namespace {

constexpr std::int32_t cells_max = (1 << 23) - 1;
constexpr int component_bits = 15;
constexpr std::uint32_t component_max = (1u << component_bits) - 2;  // even: zero has a code of its own
constexpr double component_limit = 0.70710678118654752;              // 1/√2

std::int32_t to_cells(double metres) {
  const double cells = std::nearbyint(metres / position_grid_m);
  return static_cast<std::int32_t>(std::clamp(cells, -double{cells_max} - 1, double{cells_max}));
}

}  // namespace

QuantisedPosition quantise(const WorldPosition& position) {
  QuantisedPosition q{};
  const std::int32_t cells[3] = {to_cells(position.x), to_cells(position.y), to_cells(position.z)};
  for (int axis = 0; axis < 3; ++axis)
    for (int byte = 0; byte < 3; ++byte)
      q[axis * 3 + byte] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(cells[axis]) >> (8 * byte));
  return q;
}

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

QuantisedOrientation quantise(const Eigen::Quaternionf& orientation) {
  const Eigen::Vector4d c = orientation.coeffs().cast<double>().normalized();
  int largest = 0;
  c.cwiseAbs().maxCoeff(&largest);
  const double sign = c[largest] < 0 ? -1.0 : 1.0;
  std::uint64_t bits = static_cast<std::uint64_t>(largest);
  for (int i = 0, place = 2; i < 4; ++i) {
    if (i == largest) continue;
    const double unit = std::clamp(sign * c[i] / component_limit, -1.0, 1.0) * 0.5 + 0.5;
    bits |= static_cast<std::uint64_t>(std::nearbyint(unit * component_max)) << place;
    place += component_bits;
  }
  QuantisedOrientation q{};
  for (int byte = 0; byte < 6; ++byte) q[byte] = static_cast<std::uint8_t>(bits >> (8 * byte));
  return q;
}

Eigen::Quaternionf dequantise(const QuantisedOrientation& q) {
  std::uint64_t bits = 0;
  for (int byte = 0; byte < 6; ++byte) bits |= std::uint64_t{q[byte]} << (8 * byte);
  const int largest = static_cast<int>(bits & 3);
  Eigen::Vector4d c;
  double rest = 1;
  for (int i = 0, place = 2; i < 4; ++i) {
    if (i == largest) continue;
    const double code = static_cast<double>((bits >> place) & ((1u << component_bits) - 1));
    c[i] = (std::min(code, double{component_max}) / component_max * 2 - 1) * component_limit;
    rest -= c[i] * c[i];
    place += component_bits;
  }
  c[largest] = std::sqrt(std::max(rest, 0.0));
  c.normalize();
  return Eigen::Quaternionf(c.cast<float>());
}

}  // namespace aureole
