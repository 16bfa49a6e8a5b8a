// Boxes rounded outwards.
#include "server/aura/shapes/aura_box.h"

#include <algorithm>
#include <cmath>

namespace aureole {

RoughBox RoughBox::around(const AuraBox& box) {
  RoughBox rough{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double low = box.centre[i] - box.half[i], high = box.centre[i] + box.half[i];
    // More than a float is rounded by.
    const double slack = 1e-6 * (1 + std::max(std::abs(low), std::abs(high)));
    rough.low[axis] = static_cast<float>(low - slack);
    rough.high[axis] = static_cast<float>(high + slack);
  }
  return rough;
}

}  // namespace aureole
