// The stream of an injector: any server can compute any of its bodies without having made the
// others.
#pragma once

#include <cstdint>

#include "server/base/tick.h"
#include "server/worlds/world.h"

namespace aureole {

struct InjectedBody {
  std::uint64_t n = 0;
  PrototypeId prototype;
  BodyState state;
};

/// The n-th body (from 0): a pure function of the injector's seed and n. Upright, awake, not
/// spinning; position, velocity and prototype are uniform in the injector's ranges.
InjectedBody injected_body(const Injector& injector, std::uint64_t n);

/// How many bodies have been made at the end of tick `now`: rate × time since the start, rounded
/// down; never fewer than a tick before, none before the start, no more after the duration.
std::uint64_t injected_count(const Injector& injector, Tick now);

}  // namespace aureole
