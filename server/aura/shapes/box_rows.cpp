// Sorting, and looking only where boxes may begin that reach as far as here.
#include "server/aura/shapes/box_rows.h"

#include <algorithm>
#include <limits>

#include "server/base/check.h"
#include "server/base/replace_in.h"

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
  const std::int32_t row = key.row - first_row_;
  if (row >= 0 && row + 1 < static_cast<std::int32_t>(rows_.size())) {
    const auto begin = entries_.begin() + rows_[static_cast<std::size_t>(row)].begin;
    const auto end = entries_.begin() + rows_[static_cast<std::size_t>(row) + 1].begin;
    const auto at = std::lower_bound(begin, end, key, IsBefore{});
    if (at != end && is_it(*at)) {
      // It keeps its place in the order until the next settle().
      at->box.low[2] = erased;
      erased_.push_back(static_cast<std::size_t>(at - entries_.begin()));
      return;
    }
  }
  const auto gone = std::erase_if(fresh_, is_it) + std::erase_if(large_, is_it);
  AUREOLE_CHECK(gone == 1, "only boxes that are here are erased");
}

void BoxRows::settle() {
  if (fresh_.empty() && erased_.empty()) return;
  std::sort(erased_.begin(), erased_.end());
  std::sort(fresh_.begin(), fresh_.end(), IsBefore{});
  changes_.clear();
  for (const std::size_t place : erased_) changes_.push_back({entries_[place].row, -1});
  for (const Entry& entry : fresh_) changes_.push_back({entry.row, 1});
  replace_in<Entry>(entries_, erased_, fresh_, IsBefore{});
  erased_.clear();
  fresh_.clear();
  renew_rows();
}

/// Few come and go at a time: only their rows are gone through again.
void BoxRows::renew_rows() {
  std::sort(changes_.begin(), changes_.end(),
            [](const Change& a, const Change& b) { return a.row < b.row; });
  const auto rows = static_cast<std::int32_t>(rows_.size());
  if (changes_.front().row < first_row_ || changes_.back().row - first_row_ + 1 >= rows) {
    count_rows();
    return;
  }
  std::int32_t more = 0;  // Have come than have gone so far.
  auto change = changes_.begin();
  for (std::int32_t row = change->row - first_row_; row < rows; ++row) {
    const auto at = static_cast<std::size_t>(row);
    rows_[at].begin += static_cast<std::uint32_t>(more);  // Wraps around as it should.
    if (change == changes_.end() || change->row - first_row_ != row) continue;
    for (; change != changes_.end() && change->row - first_row_ == row; ++change)
      more += change->by;
    renew_row(at, rows_[at + 1].begin + static_cast<std::uint32_t>(more));
  }
  // Rows that nobody is left in are left out at the ends.
  if (rows_.front().extent.is_empty() || rows_[rows_.size() - 2].extent.is_empty())
    count_rows();
  else
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
