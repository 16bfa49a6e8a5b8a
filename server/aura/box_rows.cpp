// Sorting, and looking only where boxes may begin that reach as far as here.
#include "server/aura/box_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/check.h"

namespace aureole {
namespace {

/// Farther than 32 km from the origin rows are one.
constexpr float farthest_row = 8192;

/// Where a box begins that has been erased: nothing is so far away.
constexpr float erased = std::numeric_limits<float>::infinity();

}  // namespace

std::int32_t BoxRows::row_of(float z) {
  const float row = std::floor(z * static_cast<float>(1 / row_m));
  // Written so that what is not a number lands somewhere, too.
  return row > -farthest_row ? static_cast<std::int32_t>(std::min(row, farthest_row))
                             : static_cast<std::int32_t>(-farthest_row);
}

void BoxRows::clear() {
  entries_.clear();
  fresh_.clear();
  large_.clear();
  begins_.clear();
  erased_ = false;
}

void BoxRows::insert(Number number, const AuraBox& box) {
  const RoughBox rough = RoughBox::around(box);
  const bool fits =
      rough.high[0] - rough.low[0] <= wide_m && rough.high[2] - rough.low[2] <= wide_m;
  (fits ? fresh_ : large_).push_back({row_of(rough.low[2]), number, rough});
}

void BoxRows::erase(Number number, const AuraBox& box) {
  const auto is_it = [&](const Entry& entry) {
    return entry.number == number && entry.box.low[2] != erased;
  };
  const RoughBox rough = RoughBox::around(box);
  const Entry key{row_of(rough.low[2]), number, rough};
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), key, is_before);
  if (at != entries_.end() && is_it(*at)) {
    // It keeps its place in the order until the next settle().
    at->box.low[2] = erased;
    erased_ = true;
    return;
  }
  const auto gone = std::erase_if(fresh_, is_it) + std::erase_if(large_, is_it);
  AUREOLE_CHECK(gone == 1, "only boxes that are here are erased");
}

void BoxRows::settle() {
  if (fresh_.empty() && !erased_) return;
  if (erased_)
    std::erase_if(entries_, [](const Entry& entry) { return entry.box.low[2] == erased; });
  erased_ = false;
  std::sort(fresh_.begin(), fresh_.end(), is_before);
  const auto middle = static_cast<std::ptrdiff_t>(entries_.size());
  entries_.insert(entries_.end(), fresh_.begin(), fresh_.end());
  std::inplace_merge(entries_.begin(), entries_.begin() + middle, entries_.end(), is_before);
  fresh_.clear();
  find_rows();
}

void BoxRows::build(std::span<const AuraBox> boxes) {
  clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) insert(static_cast<Number>(i), boxes[i]);
  entries_.swap(fresh_);
  std::sort(entries_.begin(), entries_.end(), is_before);
  find_rows();
}

void BoxRows::find_rows() {
  widest_m_ = deepest_m_ = 0;
  begins_.clear();
  if (entries_.empty()) return;
  first_row_ = entries_.front().row;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    widest_m_ = std::max(widest_m_, entry.box.high[0] - entry.box.low[0]);
    deepest_m_ = std::max(deepest_m_, entry.box.high[2] - entry.box.low[2]);
    begins_.resize(static_cast<std::size_t>(entry.row - first_row_ + 1), i);
  }
  begins_.push_back(static_cast<std::uint32_t>(entries_.size()));
}

}  // namespace aureole
