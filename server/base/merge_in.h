// Putting a few newcomers into a long sorted list.
#pragma once

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <vector>

namespace aureole {

/// As std::inplace_merge() of what is below `middle` and what is not, both sorted. Whatever lies
/// between two newcomers moves up as one block and is not looked at.
template <class T, class Before>
void merge_in(std::vector<T>& list, std::ptrdiff_t middle, Before before) {
  // Few as they are they need no memory of their own.
  constexpr std::size_t few = std::max<std::size_t>(1, 1024 / sizeof(T));
  const boost::container::small_vector<T, few> fresh(list.begin() + middle, list.end());
  auto end = list.begin() + middle;
  for (auto behind = static_cast<std::ptrdiff_t>(fresh.size()); behind > 0; --behind) {
    const T& newcomer = fresh[static_cast<std::size_t>(behind - 1)];
    const auto at = std::upper_bound(list.begin(), end, newcomer, before);
    std::move_backward(at, end, end + behind);
    *(at + behind - 1) = newcomer;
    end = at;
  }
}

}  // namespace aureole
