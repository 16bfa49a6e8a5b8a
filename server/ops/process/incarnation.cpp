// Reads the wall clock once; see incarnation.h.
#include "server/ops/process/incarnation.h"

#include <chrono>

namespace aureole {

Incarnation incarnation_of_this_start() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  const auto us = std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count();
  return Incarnation{static_cast<std::uint64_t>(us)};
}

}  // namespace aureole
