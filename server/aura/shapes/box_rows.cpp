// Sorting, and looking only where boxes may begin that reach as far as here.
#include "server/aura/shapes/box_rows.h"

#include <algorithm>
#include <limits>

#include "server/base/check.h"
#include "server/base/merge_in.h"

namespace aureole {
namespace {

/// Where a box begins that has been erased: nothing is so far away.
constexpr float erased = std::numeric_limits<float>::infinity();

}  // namespace

void BoxRows::clear() {
  entries_.clear();
  fresh_.clear();
  large_.clear();
  rows_.clear();
  erased_.clear();
  all_ = {};
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
    erased_.push_back(static_cast<std::size_t>(at - entries_.begin()));
    return;
  }
  const auto gone = std::erase_if(fresh_, is_it) + std::erase_if(large_, is_it);
  AUREOLE_CHECK(gone == 1, "only boxes that are here are erased");
}

void BoxRows::settle() {
  if (fresh_.empty() && erased_.empty()) return;
  changed_rows_.clear();
  drop_erased();
  take_in_fresh();
  renew_rows();
}

/// What lies between two of them moves down as one block.
void BoxRows::drop_erased() {
  if (erased_.empty()) return;
  std::sort(erased_.begin(), erased_.end());
  auto to = entries_.begin() + static_cast<std::ptrdiff_t>(erased_.front());
  for (std::size_t n = 0; n < erased_.size(); ++n) {
    const auto gone = entries_.begin() + static_cast<std::ptrdiff_t>(erased_[n]);
    const auto end = n + 1 < erased_.size()
                         ? entries_.begin() + static_cast<std::ptrdiff_t>(erased_[n + 1])
                         : entries_.end();
    changed_rows_.push_back(gone->row);
    to = std::move(gone + 1, end, to);
  }
  entries_.erase(to, entries_.end());
  erased_.clear();
}

void BoxRows::take_in_fresh() {
  if (fresh_.empty()) return;
  std::sort(fresh_.begin(), fresh_.end(), IsBefore{});
  for (const Entry& entry : fresh_) changed_rows_.push_back(entry.row);
  const auto middle = static_cast<std::ptrdiff_t>(entries_.size());
  entries_.insert(entries_.end(), fresh_.begin(), fresh_.end());
  merge_in(entries_, middle, IsBefore{});
  fresh_.clear();
}

/// Few come and go at a time: only their rows are gone through again.
void BoxRows::renew_rows() {
  const auto is_outside = [&](std::int32_t row) {
    return row < first_row_ || row - first_row_ + 1 >= static_cast<std::int32_t>(rows_.size());
  };
  if (changed_rows_.size() > rows_.size() / 4 ||
      std::any_of(changed_rows_.begin(), changed_rows_.end(), is_outside)) {
    count_rows();
    return;
  }
  std::sort(changed_rows_.begin(), changed_rows_.end());
  changed_rows_.erase(std::unique(changed_rows_.begin(), changed_rows_.end()), changed_rows_.end());
  for (const std::int32_t number : changed_rows_) {
    const auto at = static_cast<std::size_t>(number - first_row_);
    std::uint32_t end = rows_[at].begin;
    while (end < entries_.size() && entries_[end].row == number) ++end;
    renew_row(at, end);
    // Unsigned: what is taken from each wraps around as it should.
    const std::uint32_t more = end - rows_[at + 1].begin;
    if (more == 0) continue;
    for (std::size_t behind = at + 1; behind < rows_.size(); ++behind) rows_[behind].begin += more;
  }
  // Rows that nobody is left in are left out at the ends.
  if (rows_.front().extent.is_empty() || rows_[rows_.size() - 2].extent.is_empty()) {
    count_rows();
    return;
  }
  sum_up_rows();
}

void BoxRows::sum_up_rows() {
  deepest_m_ = 0;
  all_ = {};
  for (const Row& row : rows_) {
    deepest_m_ = std::max(deepest_m_, row.deepest_m);
    all_.take_in(row.extent);
  }
}

void BoxRows::build(std::span<const AuraBox> boxes) {
  clear();
  fresh_.reserve(boxes.size());
  std::int32_t first = std::numeric_limits<std::int32_t>::max();
  std::int32_t last = std::numeric_limits<std::int32_t>::min();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    insert(static_cast<Number>(i), boxes[i]);
    if (fresh_.empty()) continue;
    first = std::min(first, fresh_.back().row);
    last = std::max(last, fresh_.back().row);
  }
  if (fresh_.empty()) return;
  span_rows(first, last);
  next_.assign(rows_.size(), 0);
  for (const Entry& entry : fresh_) ++next_[static_cast<std::size_t>(entry.row - first)];
  std::uint32_t begin = 0;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    rows_[row].begin = begin;
    begin += std::exchange(next_[row], begin);
  }
  // Into their rows first: what is left to sort is short.
  entries_.resize(fresh_.size());
  for (const Entry& entry : fresh_)
    entries_[next_[static_cast<std::size_t>(entry.row - first)]++] = entry;
  fresh_.clear();
  for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
    if (next_[row] - rows_[row].begin > 1)
      std::sort(entries_.begin() + rows_[row].begin, entries_.begin() + next_[row], IsBefore{});
    renew_row(row, next_[row]);
  }
  sum_up_rows();
}

/// Rows from one to another, and the end of the last one; all of them empty.
void BoxRows::span_rows(std::int32_t first, std::int32_t last) {
  first_row_ = first;
  rows_.assign(static_cast<std::size_t>(last - first) + 2, {});
}

/// All rows anew, of sorted entries.
void BoxRows::count_rows() {
  rows_.clear();
  if (!entries_.empty()) {
    span_rows(entries_.front().row, entries_.back().row);
    std::uint32_t end = 0;
    for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
      rows_[row].begin = end;
      const std::int32_t number = first_row_ + static_cast<std::int32_t>(row);
      while (end < entries_.size() && entries_[end].row == number) ++end;
      renew_row(row, end);
    }
    rows_.back().begin = end;
  }
  sum_up_rows();
}

/// From its boxes: those from where it begins to `end`.
void BoxRows::renew_row(std::size_t row, std::uint32_t end) {
  float widest_m = 0, deepest_m = 0;
  GroundExtent extent;
  for (std::uint32_t at = rows_[row].begin; at < end; ++at) {
    const RoughBox& box = entries_[at].box;
    widest_m = std::max(widest_m, box.high[0] - box.low[0]);
    deepest_m = std::max(deepest_m, box.high[2] - box.low[2]);
    extent.take_in(GroundExtent(box));
  }
  rows_[row].widest_m = widest_m;
  rows_[row].deepest_m = deepest_m;
  rows_[row].extent = extent;
}

}  // namespace aureole
