// Log lines for tolerances that are left and kept again.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>

#include "server/region/tolerances/tolerances.h"

namespace aureole {

/// One line a second at most for each kind, peer and direction; how many more there were stands in
/// the next one.
class ToleranceLog {
 public:
  void add(std::span<const ToleranceEvent> events);
  /// The line for an event, or nothing if it is too soon for another one.
  std::string line(const ToleranceEvent& event);

 private:
  struct Said {
    Tick at;
    std::uint64_t unsaid = 0;
  };
  std::map<std::tuple<ToleranceEvent::Kind, RegionId, bool>, Said> said_;
};

}  // namespace aureole
