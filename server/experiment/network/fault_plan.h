// What goes wrong in a run, and when: a list that is drawn from the seed before the run begins.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "server/experiment/network/simulated_network.h"

namespace aureole {

enum class FaultKinds : std::uint8_t { none, links, crashes, all };
std::string_view name_of(FaultKinds kinds);
/// "none", "links", "crashes", "all".
std::optional<FaultKinds> fault_kinds_from(std::string_view name);

struct Fault {
  enum class Kind : std::uint8_t {
    stall,          ///< Both directions between a and b are held for a while.
    stall_one_way,  ///< Only what a sends to b; sometimes so long that it looks like a crash.
    reset,          ///< What is in flight between a and b is lost.
    slow,           ///< a's frames take longer than a tick.
    crash,          ///< a is killed and started again later.
  };
  Micros at_us = 0;
  Kind kind{};
  End a = 0, b = 0;
  Micros duration_us = 0;   ///< crash: until it is started again
  double frame_ms = 0;      ///< slow
  bool loses_disk = false;  ///< crash of a region
};

struct FaultPlanOptions {
  FaultKinds kinds = FaultKinds::none;
  int regions = 0;      ///< The gateway is end `regions`.
  Micros until_us = 0;  ///< The last fault begins and ends before.
  std::uint64_t seed = 0;
};

/// Ascending by time. Crashes of one region do not overlap; a disk is lost only while the gateway's
/// store is up and has been for a second, and no other region is down, so that what was on it is
/// known somewhere.
std::vector<Fault> plan_faults(const FaultPlanOptions& options);

}  // namespace aureole
