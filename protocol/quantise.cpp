// Poses in few bits: 24 bits an axis, and the smallest three components of a quaternion.
#include "protocol/quantise.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace aureole {
namespace {

constexpr std::int32_t cells_max = (1 << 23) - 1;
constexpr int component_bits = 15;
constexpr std::int32_t component_max = (1 << component_bits) - 2;  // even: zero has its own code
constexpr std::int32_t component_zero = component_max / 2;
constexpr double component_limit = 0.70710678118654752;  // 1/√2

/// The nearest whole number, of two the even one, as std::nearbyint() has it, but without a call:
/// past 2^52 doubles have no digits behind the point. Requires |value| < 2^51.
double nearest(double value) {
  constexpr double no_fractions = 0x1.8p52;
  return (value + no_fractions) - no_fractions;
}

std::int32_t to_cells(double metres) {
  if (std::isnan(metres)) return 0;
  const double cells =
      std::clamp(metres / position_grid_m, -double{cells_max} - 1, double{cells_max});
  return static_cast<std::int32_t>(nearest(cells));
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
  return std::abs(squared - 1) < 1e-6 ? 1.5 - 0.5 * squared : 1 / std::sqrt(squared);
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

}  // namespace

QuantisedPosition quantise(const WorldPosition& position) {
  QuantisedPosition q{};
  const std::int32_t cells[3] = {to_cells(position.x), to_cells(position.y), to_cells(position.z)};
  // Packed first and then stored: 24 bits each are eight bytes and the last one.
  const auto bits = [&](int axis) {
    return std::uint64_t{static_cast<std::uint32_t>(cells[axis]) & 0xffffff};
  };
  const std::uint64_t first = bits(0) | bits(1) << 24 | bits(2) << 48;
  std::memcpy(q.data(), &first, sizeof first);
  q[8] = static_cast<std::uint8_t>(bits(2) >> 16);
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

std::uint64_t orientation_bits(const Eigen::Quaternionf& orientation) {
  SmallestThree packed;
  const Eigen::Vector4d coefficients = orientation.coeffs().cast<double>();
  const double squared_norm = coefficients.squaredNorm();
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
    // The first condition spares nearly all orientations the second one. In steps the radius of the
    // unit sphere is √2 × component_zero; one step of distance is far more than floats lose.
    const double radius_squared = 2.0 * component_zero * component_zero;
    if (radius_squared - squares < (second + 1) * (second + 1) && !is_stable(packed))
      make_stable(packed, exact);
  }

  std::uint64_t bits = static_cast<std::uint64_t>(packed.largest);
  for (int k = 0; k < 3; ++k)
    bits |= static_cast<std::uint64_t>(packed.codes[k]) << (2 + k * component_bits);
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
