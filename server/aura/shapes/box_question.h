// One box asked of many others whether they meet it.
#pragma once

#include <cstddef>

#include "server/aura/shapes/aura_box.h"

#ifdef __SSE2__
#include <emmintrin.h>
#include <limits>
#endif

namespace aureole {

/// RoughBox::meets() of one box with many: six comparisons in two instructions where the processor
/// has them. What comes out is the same.
class BoxQuestion {
 public:
  explicit BoxQuestion(const RoughBox& asked);
  bool met_by(const RoughBox& box) const;

 private:
#ifdef __SSE2__
  /// What the first four of a box's six numbers (low x, y, z, high x) must not exceed, …
  __m128 at_most_;
  /// … and what its last four (low z, high x, y, z) must reach.
  __m128 at_least_;
#else
  RoughBox asked_;
#endif
};

#ifdef __SSE2__

inline BoxQuestion::BoxQuestion(const RoughBox& asked)
    : at_most_(_mm_setr_ps(asked.high[0], asked.high[1], asked.high[2],
                           std::numeric_limits<float>::infinity())),
      at_least_(_mm_setr_ps(-std::numeric_limits<float>::infinity(), asked.low[0], asked.low[1],
                            asked.low[2])) {}

inline bool BoxQuestion::met_by(const RoughBox& box) const {
  static_assert(offsetof(RoughBox, low) == 0 && offsetof(RoughBox, high) == 3 * sizeof(float) &&
                    sizeof(RoughBox) == 6 * sizeof(float),
                "a box is six numbers side by side");
  const float* numbers = box.low.data();
  const __m128 first = _mm_loadu_ps(numbers), last = _mm_loadu_ps(numbers + 2);
  const __m128 holds = _mm_and_ps(_mm_cmple_ps(first, at_most_), _mm_cmpge_ps(last, at_least_));
  return _mm_movemask_ps(holds) == 0b1111;
}

#else

inline BoxQuestion::BoxQuestion(const RoughBox& asked) : asked_(asked) {}
inline bool BoxQuestion::met_by(const RoughBox& box) const {
  return box.meets(asked_);
}

#endif

}  // namespace aureole
