// Sorting, and looking only where boxes may begin that reach as far as here.
#include "server/aura/shapes/box_rows.h"

#include <algorithm>
#include <limits>

#include "server/base/check.h"
#include "server/base/merge_in.h"

namespace aureole {
namespace {

/// Farther than 32 km from the origin rows are one.
constexpr float farthest_row = 8192;

/// Where a box begins that has been erased: nothing is so far away.
constexpr float erased = std::numeric_limits<float>::infinity();

}  // namespace

std::int32_t BoxRows::row_of(float z) {
  const float rows = z * static_cast<float>(1 / row_m);
  // Written so that what is not a number lands somewhere, too.
  if (!(rows > -farthest_row)) return static_cast<std::int32_t>(-farthest_row);
  const float near = std::min(rows, farthest_row);
  // The same as std::floor, without its call.
  const auto whole = static_cast<std::int32_t>(near);
  return whole - (static_cast<float>(whole) > near ? 1 : 0);
}

void BoxRows::clear() {
  entries_.clear();
  fresh_.clear();
  large_.clear();
  rows_.clear();
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
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), key, IsBefore{});
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
  std::sort(fresh_.begin(), fresh_.end(), IsBefore{});
  const auto middle = static_cast<std::ptrdiff_t>(entries_.size());
  entries_.insert(entries_.end(), fresh_.begin(), fresh_.end());
  merge_in(entries_, middle, IsBefore{});
  fresh_.clear();
  count_rows(entries_);
}

void BoxRows::build(std::span<const AuraBox> boxes) {
  clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) insert(static_cast<Number>(i), boxes[i]);
  count_rows(fresh_);
  if (fresh_.empty()) return;
  // Into their rows first: what is left to sort is short.
  entries_.resize(fresh_.size());
  next_.clear();
  for (const Row& row : rows_) next_.push_back(row.begin);
  for (const Entry& entry : fresh_)
    entries_[next_[static_cast<std::size_t>(entry.row - first_row_)]++] = entry;
  fresh_.clear();
  for (std::size_t row = 0; row + 1 < rows_.size(); ++row)
    std::sort(entries_.begin() + rows_[row].begin, entries_.begin() + next_[row], IsBefore{});
}

void BoxRows::count_rows(std::span<const Entry> entries) {
  deepest_m_ = 0;
  rows_.clear();
  if (entries.empty()) return;
  std::int32_t last_row = first_row_ = entries.front().row;
  for (const Entry& entry : entries) {
    first_row_ = std::min(first_row_, entry.row);
    last_row = std::max(last_row, entry.row);
  }
  rows_.resize(static_cast<std::size_t>(last_row - first_row_) + 2);
  for (const Entry& entry : entries) {
    const RoughBox& box = entry.box;
    deepest_m_ = std::max(deepest_m_, box.high[2] - box.low[2]);
    const auto number = static_cast<std::size_t>(entry.row - first_row_);
    Row& row = rows_[number];
    row.widest_m = std::max(row.widest_m, box.high[0] - box.low[0]);
    row.low_x = std::min(row.low_x, box.low[0]);
    row.high_x = std::max(row.high_x, box.high[0]);
    row.high_z = std::max(row.high_z, box.high[2]);
    ++rows_[number + 1].begin;
  }
  for (std::size_t row = 1; row < rows_.size(); ++row) rows_[row].begin += rows_[row - 1].begin;
}

}  // namespace aureole
