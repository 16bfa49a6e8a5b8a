// Boxes rounded outwards.
#include "server/aura/shapes/aura_box.h"

#include <algorithm>
#include <cmath>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace aureole {
namespace {

/// Of the distance from the origin: more than a float is rounded by.
constexpr double rounding = 1e-6;

}  // namespace

// Two axes at once where the processor can: every box that is sorted or asked for comes here.
#ifdef __SSE2__

namespace {

/// The lower and the upper end along two axes, rounded outwards.
struct RoughEnds {
  __m128 low, high;

  RoughEnds(__m128d centre, __m128d half) {
    const __m128d sign = _mm_set1_pd(-0.0);
    const __m128d exact_low = _mm_sub_pd(centre, half), exact_high = _mm_add_pd(centre, half);
    const __m128d farther =
        _mm_max_pd(_mm_andnot_pd(sign, exact_low), _mm_andnot_pd(sign, exact_high));
    const __m128d slack = _mm_mul_pd(_mm_set1_pd(rounding), _mm_add_pd(_mm_set1_pd(1), farther));
    low = _mm_cvtpd_ps(_mm_sub_pd(exact_low, slack));
    high = _mm_cvtpd_ps(_mm_add_pd(exact_high, slack));
  }
};

}  // namespace

RoughBox RoughBox::around(const AuraBox& box) {
  const RoughEnds xy(_mm_loadu_pd(&box.centre[0]), _mm_loadu_pd(&box.half[0]));
  const RoughEnds z(_mm_load_sd(&box.centre[2]), _mm_load_sd(&box.half[2]));
  RoughBox rough;
  _mm_storel_pi(reinterpret_cast<__m64*>(&rough.low[0]), xy.low);
  _mm_store_ss(&rough.low[2], z.low);
  _mm_storel_pi(reinterpret_cast<__m64*>(&rough.high[0]), xy.high);
  _mm_store_ss(&rough.high[2], z.high);
  return rough;
}

#else

RoughBox RoughBox::around(const AuraBox& box) {
  RoughBox rough{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double low = box.centre[i] - box.half[i], high = box.centre[i] + box.half[i];
    const double slack = rounding * (1 + std::max(std::abs(low), std::abs(high)));
    rough.low[axis] = static_cast<float>(low - slack);
    rough.high[axis] = static_cast<float>(high + slack);
  }
  return rough;
}

#endif

}  // namespace aureole
