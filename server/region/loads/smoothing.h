// Means that follow what is looked at again and again.
#pragma once

#include <algorithm>
#include <cstdint>

namespace aureole {

/// The share of the newest of `looks` (> 0) in a mean that follows so many of them: until there
/// have been as many it is the mean of all.
inline double share_of_newest(std::int64_t looks, double looks_in_mind) {
  return std::max(1.0 / static_cast<double>(looks), 1.0 / looks_in_mind);
}

}  // namespace aureole
