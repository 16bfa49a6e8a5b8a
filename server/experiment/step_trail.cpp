// The first difference of two trails.
#include "server/experiment/step_trail.h"

#include <fmt/format.h>

#include <algorithm>

#include "server/experiment/seed_result.h"

namespace aureole {

Violation tell_difference(const SeedResult& first, const SeedResult& second) {
  Violation told{"repeatable", 0,
                 fmt::format("the second run's hash is {:016x}, the first one's {:016x}",
                             second.hash, first.hash)};
  const auto [a, b] = std::mismatch(first.trail.begin(), first.trail.end(), second.trail.begin(),
                                    second.trail.end());
  const bool ended_a = a == first.trail.end(), ended_b = b == second.trail.end();
  if (ended_a && ended_b) return told;
  const StepMark& one = ended_a ? *b : *a;
  told.tick = one.tick;
  if (ended_a || ended_b) {
    told.what += fmt::format("; only the {} run has a step of r{} there",
                             ended_a ? "second" : "first", one.server);
  } else if (a->tick != b->tick || a->server != b->server) {
    told.what += fmt::format(
        "; the next step is r{}'s in the first run, r{}'s (tick {}) in the "
        "second",
        a->server, b->server, b->tick);
  } else {
    told.what += fmt::format(
        "; the first step that differs is r{}'s, with {} bodies in the first "
        "run and {} in the second",
        a->server, a->bodies, b->bodies);
  }
  return told;
}

}  // namespace aureole
