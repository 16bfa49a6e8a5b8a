// Crowds made by hand.
#pragma once

#include "server/region/lines/crowd.h"

namespace aureole::testing {

/// Bodies in one bin, by where it begins.
inline void put(Crowd& crowd, double from_m, double bodies) {
  crowd.awake[static_cast<std::size_t>((from_m - Crowd::from_m) / Crowd::bin_m)] += bodies;
}

}  // namespace aureole::testing
