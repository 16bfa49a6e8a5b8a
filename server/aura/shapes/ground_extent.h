// How far boxes reach over the ground.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "server/aura/shapes/aura_box.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace aureole {

/// The rectangle around boxes. Held as the least of x, of z, of −x and of −z: then all four sides
/// are compared, or moved outwards, alike, and at once where the processor can.
class GroundExtent {
 public:
  /// Of no boxes: nothing that has bounds meets it.
  GroundExtent() { least_.fill(nowhere); }
  explicit GroundExtent(const RoughBox& box)
      : least_{box.low[0], box.low[2], -box.high[0], -box.high[2]} {}

  bool is_empty() const { return least_[0] == nowhere; }
  bool meets(const GroundExtent& other) const {
#ifdef __SSE2__
    // x of the one with −x of the other, and so on: neither lies wholly beyond the other.
    const __m128 farthest = _mm_xor_ps(_mm_set1_ps(-0.f), other.numbers());
    const __m128 crossed = _mm_shuffle_ps(farthest, farthest, 0b01'00'11'10);
    return _mm_movemask_ps(_mm_cmple_ps(numbers(), crossed)) == 0b1111;
#else
    return (least_[0] <= -other.least_[2]) & (least_[1] <= -other.least_[3]) &
           (least_[2] <= -other.least_[0]) & (least_[3] <= -other.least_[1]);
#endif
  }
  void take_in(const GroundExtent& other) {
#ifdef __SSE2__
    _mm_store_ps(least_.data(), _mm_min_ps(numbers(), other.numbers()));
#else
    for (std::size_t side = 0; side < least_.size(); ++side)
      least_[side] = std::min(least_[side], other.least_[side]);
#endif
  }

 private:
  static constexpr float nowhere = std::numeric_limits<float>::infinity();
#ifdef __SSE2__
  __m128 numbers() const {
    return _mm_load_ps(least_.data());
  }
#endif
  alignas(16) std::array<float, 4> least_;
};

}  // namespace aureole
