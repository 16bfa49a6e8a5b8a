// Runs that oracles are shown, and what comes of them.
#pragma once

#include <algorithm>
#include <string>

#include "server/experiment/simulation.h"

namespace aureole {

inline SimulationOptions calm(double seconds) {
  SimulationOptions options;
  options.scenario.seed = 1;
  options.scenario.seconds = seconds;
  return options;
}

inline bool told_of(const SeedResult& result, const std::string& rule) {
  return std::any_of(result.violations.begin(), result.violations.end(),
                     [&](const Violation& v) { return v.rule == rule; });
}

}  // namespace aureole
