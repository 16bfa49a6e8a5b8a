// Taking a few out of a long sorted list and putting a few others in.
#pragma once

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cstddef>
#include <span>
#include <vector>

namespace aureole {

/// Who is at the places `gone` (ascending, each once) goes, and `fresh` (sorted, not part of the
/// list, equal to nobody who stays) comes. What lies between two such places moves as one block, by
/// as many as have come before it less those that have gone: where one goes and one comes nothing
/// but what is between them.
template <class T, class Before>
void replace_in(std::vector<T>& list, std::span<const std::size_t> gone, std::span<const T> fresh,
                Before before) {
  struct Edit {
    std::size_t place;
    const T* newcomer;  ///< Comes before who is there; null: who is there goes.
    std::ptrdiff_t step() const { return newcomer != nullptr ? 1 : -1; }
    std::size_t behind() const { return newcomer != nullptr ? place : place + 1; }
  };
  boost::container::small_vector<Edit, 32> edits;
  auto going = gone.begin();
  auto at = list.begin();
  for (const T& newcomer : fresh) {
    at = std::lower_bound(at, list.end(), newcomer, before);
    const auto place = static_cast<std::size_t>(at - list.begin());
    for (; going != gone.end() && *going < place; ++going) edits.push_back({*going, nullptr});
    edits.push_back({place, &newcomer});
  }
  for (; going != gone.end(); ++going) edits.push_back({*going, nullptr});

  const std::size_t size_before = list.size();
  const std::size_t size_after = size_before + fresh.size() - gone.size();
  list.resize(std::max(size_before, size_after));
  const auto place_at = [&](std::size_t place, std::ptrdiff_t shift) {
    return list.begin() + (static_cast<std::ptrdiff_t>(place) + shift);
  };
  const auto end_of_block = [&](std::size_t n) {
    return n + 1 < edits.size() ? edits[n + 1].place : size_before;
  };
  std::ptrdiff_t shift = 0;
  for (std::size_t n = 0; n < edits.size();) {
    shift += edits[n].step();
    if (shift <= 0) {
      if (shift < 0)
        std::move(place_at(edits[n].behind(), 0), place_at(end_of_block(n), 0),
                  place_at(edits[n].behind(), shift));
      ++n;
      continue;
    }
    // Of blocks side by side that all move up the last one makes room first.
    std::size_t end = n + 1;
    while (end < edits.size() && shift + edits[end].step() > 0) shift += edits[end++].step();
    std::ptrdiff_t up = shift;
    for (std::size_t k = end; k-- > n; up -= edits[k].step())
      std::move_backward(place_at(edits[k].behind(), 0), place_at(end_of_block(k), 0),
                         place_at(end_of_block(k), up));
    n = end;
  }
  shift = 0;
  for (const Edit& edit : edits) {
    if (edit.newcomer != nullptr) *place_at(edit.place, shift) = *edit.newcomer;
    shift += edit.step();
  }
  list.resize(size_after);
}

}  // namespace aureole
