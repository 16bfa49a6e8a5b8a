// Caches emptied before what is measured begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aureole {

/// Servers that take turns in one process share its caches: a few find everything where they left
/// it, many find nothing, and the cost of one seems to grow with their number. Where each begins
/// with cold caches the two can be compared. It is dearer than any server of its own would have it.
class ColdCaches {
 public:
  /// Takes memory of twice the last cache's size, or of 64 MiB where nobody knows that.
  ColdCaches();
  /// Reads all of it.
  void chill();
  std::size_t bytes() const { return memory_.size() * sizeof(Line); }

 private:
  struct alignas(64) Line {
    std::uint64_t count = 0;
  };
  std::vector<Line> memory_;
  volatile std::uint64_t sum_ = 0;  ///< So that it is read.
};

}  // namespace aureole
