// Searching on in a sorted list whose next hits are near.
#pragma once

#include <algorithm>
#include <iterator>

namespace aureole {

/// As std::lower_bound() from `at` on, but in steps that double: what lies near costs little, and
/// the rest of the list is not touched.
template <class Iterator, class Key, class Before>
Iterator leap(Iterator at, Iterator end, const Key& key, Before before) {
  typename std::iterator_traits<Iterator>::difference_type step = 1;
  while (end - at > step && before(at[step], key)) {
    at += step;
    step *= 2;
  }
  return std::lower_bound(at, at + std::min(step + 1, end - at), key, before);
}

}  // namespace aureole
