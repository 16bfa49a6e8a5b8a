// Finds overlapping boxes: rows of z, sorted by x within each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/aura/aura_box.h"

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

  /// Boxes anew, numbered by their places.
  void build(std::span<const AuraBox> boxes);
  /// The same, and those of `others` that `wanted(number, box)` says, with `offset` on top of the
  /// numbers that they have there.
  template <class IsWanted>
  void build(std::span<const AuraBox> boxes, const BoxRows& others, Number offset,
             IsWanted&& wanted) {
    begin(boxes);
    auto own = fresh_.begin();
    for (const Entry& entry : others.entries_) {
      if (!wanted(entry.number, entry.box)) continue;
      while (own != fresh_.end() && is_before(*own, entry)) entries_.push_back(*own++);
      entries_.push_back({entry.row, entry.number + offset, entry.box});
    }
    entries_.insert(entries_.end(), own, fresh_.end());
    for (const Entry& entry : others.large_)
      if (wanted(entry.number, entry.box))
        large_.push_back({entry.row, entry.number + offset, entry.box});
    fresh_.clear();
    find_rows();
  }
  void clear();

  /// From settle() on a box is found under this number.
  void insert(Number number, const AuraBox& box);
  /// A box that is here, as it was inserted; it is not found any more.
  void erase(Number number, const AuraBox& box);
  /// Call after insert() and erase(), before questions.
  void settle();

  /// Appends the numbers of all boxes that overlap `box`, and perhaps of some that miss it by a
  /// millionth part, each once, in an order that depends on the boxes and their numbers only.
  void find(const AuraBox& box, std::vector<Number>& found) const;

 private:
  struct Entry {
    std::int32_t row;
    Number number;
    RoughBox box;
  };
  static bool is_before(const Entry& a, const Entry& b) {
    if (a.row != b.row) return a.row < b.row;
    if (a.box.low[0] != b.box.low[0]) return a.box.low[0] < b.box.low[0];
    return a.number < b.number;
  }
  void begin(std::span<const AuraBox> boxes);
  void find_rows();

  std::vector<Entry> entries_;  ///< Sorted.
  std::vector<Entry> fresh_;    ///< Since settle().
  std::vector<Entry> large_;    ///< Kept apart.
  bool erased_ = false;         ///< Some of `entries_` are.
  float widest_m_ = 0, deepest_m_ = 0;
  std::int32_t first_row_ = 0;
  std::vector<std::uint32_t> begins_;  ///< Of each row from the first on, and where the last ends.
};

}  // namespace aureole
