// Finds overlapping boxes: rows of z, sorted by x within each.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "server/aura/shapes/aura_box.h"
#include "server/aura/shapes/box_question.h"
#include "server/aura/shapes/ground_extent.h"

namespace aureole {

/// One flat list of 32 bytes a box, sorted by the row in which a box begins, then by where in x it
/// begins. A question looks, in each row that boxes as deep as the deepest may come from, at those
/// side by side that begin near enough, and touches nothing else: between two questions of a server
/// lies a physics step, after which everything has to be fetched from far away. (In a grid of cells
/// most of the time of a question went into fetching them.)
class BoxRows {
 public:
  using Number = std::uint32_t;
  /// Depth of a row (unit: m): about the size of one aura.
  static constexpr double row_m = 4.0;
  /// What is wider or deeper is kept apart and asked one by one (m): the widest box of a row widens
  /// every question.
  static constexpr float wide_m = 12.0f;
  /// In a longer row the first box is searched for.
  static constexpr std::ptrdiff_t long_row = 16;

  /// Boxes anew, numbered by their places.
  void build(std::span<const AuraBox> boxes);
  void clear();

  /// From settle() on a box is found under this number.
  void insert(Number number, const AuraBox& box);
  /// A box that is here, as it was inserted; it is not found any more.
  void erase(Number number, const AuraBox& box);
  /// Call after insert() and erase(), before questions.
  void settle();

  /// Appends the numbers of all boxes that overlap `box`, and perhaps of some that miss it by a
  /// millionth part, each once, in an order that depends on the boxes and their numbers only.
  void find(const AuraBox& box, std::vector<Number>& found) const {
    find_each(RoughBox::around(box), [&](const Hit& hit) { found.push_back(hit.number); });
  }
  /// One that is found. In their order by place the hits of two lists are those of one that holds
  /// the boxes of both.
  struct Hit {
    Number number;
    std::pair<std::int32_t, float> place;
    const RoughBox& box;  ///< Valid until the list changes.
  };
  /// The same, as `found(hit)`.
  template <class Found>
  void find_each(const RoughBox& asked, Found&& found) const {
    const BoxQuestion question(asked);
    const GroundExtent ground(asked);
    if (all_.meets(ground)) find_in_rows(asked, ground, question, found);
    for (const Entry& entry : large_)
      if (question.met_by(entry.box))
        found(hit_of(entry, std::numeric_limits<std::int32_t>::max()));
  }

 private:
  struct Entry {
    std::int32_t row;
    Number number;
    RoughBox box;
  };
  struct IsBefore {
    bool operator()(const Entry& a, const Entry& b) const {
      if (a.row != b.row) return a.row < b.row;
      if (a.box.low[0] != b.box.low[0]) return a.box.low[0] < b.box.low[0];
      return a.number < b.number;
    }
  };
  template <class Found>
  void find_in_rows(const RoughBox& asked, const GroundExtent& ground, const BoxQuestion& question,
                    Found&& found) const {
    const auto rows = static_cast<std::int32_t>(rows_.size()) - 1;
    const std::int32_t first = std::max(row_of(asked.low[2] - deepest_m_) - first_row_, 0);
    const std::int32_t last = std::min(row_of(asked.high[2]) - first_row_, rows - 1);
    for (std::int32_t number = first; number <= last; ++number) {
      const Row& row = rows_[static_cast<std::size_t>(number)];
      if (!row.extent.meets(ground)) continue;
      const Entry* at = entries_.data() + row.begin;
      const Entry* end = entries_.data() + rows_[static_cast<std::size_t>(number) + 1].begin;
      if (end - at > long_row) at += first_from(at, end - at, asked.low[0] - row.widest_m);
      look_through(at, end, asked, question, found);
    }
  }
  /// How many of them begin before x: std::lower_bound() without branches that nobody can foretell.
  static std::ptrdiff_t first_from(const Entry* entries, std::ptrdiff_t count, float x) {
    const Entry* at = entries;
    while (count > 1) {
      const std::ptrdiff_t half = count / 2;
      at += half & -std::ptrdiff_t{at[half - 1].box.low[0] < x};
      count -= half;
    }
    return at - entries + (at->box.low[0] < x ? 1 : 0);
  }
  void span_rows(std::int32_t first, std::int32_t last);
  void count_rows();
  void renew_row(std::size_t row, std::uint32_t end);
  void renew_rows();
  void sum_up_rows();
  static std::int32_t row_of(float z) {
    // Farther than 32 km from the origin rows are one. Written so that what is not a number lands
    // somewhere, too.
    constexpr float farthest = 8192;
    const float rows = std::min(std::max(-farthest, z * static_cast<float>(1 / row_m)), farthest);
    // The same as std::floor, without its call.
    const auto whole = static_cast<std::int32_t>(rows);
    return whole - (static_cast<float>(whole) > rows ? 1 : 0);
  }
  static Hit hit_of(const Entry& entry, std::int32_t row) {
    return {entry.number, {row, entry.box.low[0]}, entry.box};
  }
  /// Those of one row that begin near enough. Whether a box is met can hardly be foretold: who are
  /// is noted in the bits of a word first, without a branch for each.
  template <class Found>
  static void look_through(const Entry* at, const Entry* end, const RoughBox& asked,
                           const BoxQuestion& question, Found&& found) {
    constexpr std::ptrdiff_t word_bits = 32;
    for (;;) {
      std::uint32_t met = 0;
      std::ptrdiff_t n = 0;
      for (; n < word_bits && at + n != end && at[n].box.low[0] <= asked.high[0]; ++n)
        met |= std::uint32_t{question.met_by(at[n].box)} << n;
      for (; met != 0; met &= met - 1) {
        const Entry& entry = at[std::countr_zero(met)];
        found(hit_of(entry, entry.row));
      }
      if (n < word_bits) return;
      at += word_bits;
    }
  }

  std::vector<Entry> entries_;       ///< Sorted.
  std::vector<Entry> fresh_;         ///< Since settle().
  std::vector<Entry> large_;         ///< Kept apart.
  std::vector<std::size_t> erased_;  ///< Places in `entries_` that are, since settle().
  struct Row {
    std::uint32_t begin = 0;
    float widest_m = 0, deepest_m = 0;  ///< Of its boxes.
    GroundExtent extent;                ///< The same.
  };
  GroundExtent all_;  ///< Of all in rows: many questions are about what is far from all of them.
  float deepest_m_ = 0;
  std::int32_t first_row_ = 0;
  std::vector<Row> rows_;  ///< From the first one on; one more begins where the last ends.
  std::vector<std::uint32_t> next_;  ///< Only used within build(): where each row goes on.
  struct Change {
    std::int32_t row, by;  ///< How many more there are in it.
  };
  std::vector<Change> changes_;  ///< Only used within settle(); of some rows several.
};

}  // namespace aureole
