// Bullet's lists of objects, kept in the order in which the objects lie in memory.
#pragma once

#include <LinearMath/btAlignedObjectArray.h>

#include <algorithm>
#include <functional>

#include "server/base/check.h"

namespace aureole {

/// Puts `object` into a list in the order of addresses. Every step walks through these lists
/// several times, and what lies in order the processor fetches ahead.
template <class T>
void put_in_address_order(btAlignedObjectArray<T*>& list, T* object) {
  list.push_back(object);
  T** const last = &list[0] + list.size();
  T** const place = std::lower_bound(&list[0], last - 1, object, std::less<>{});
  std::move_backward(place, last - 1, last);
  *place = object;
}

/// Takes one that is in the list out of it.
template <class T>
void take_from_address_order(btAlignedObjectArray<T*>& list, T* object) {
  AUREOLE_CHECK(list.size() > 0, "only what is in a list is taken out of it");
  T** const last = &list[0] + list.size();
  T** const place = std::lower_bound(&list[0], last, object, std::less<>{});
  AUREOLE_CHECK(place != last && *place == object, "only what is in a list is taken out of it");
  std::move(place + 1, last, place);
  list.pop_back();
}

}  // namespace aureole
