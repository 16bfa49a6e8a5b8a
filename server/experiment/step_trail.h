// The states of all servers after every step, as hashes: where two runs of one seed part.
#pragma once

#include <cstdint>
#include <vector>

namespace aureole {

struct SeedResult;
struct Violation;

/// One step of one server, in the order in which they were taken.
struct StepMark {
  std::int64_t tick = 0;
  std::uint16_t server = 0;
  std::uint64_t bodies = 0;
  std::uint64_t hash = 0;
  friend bool operator==(const StepMark&, const StepMark&) = default;
};

/// What to say of two runs of one seed whose hashes differ: the first step at which they do, with
/// its server; tick 0 where neither kept its trail.
Violation tell_difference(const SeedResult& first, const SeedResult& second);

}  // namespace aureole
