// Log lines for tolerances that are left and kept again.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/region/tolerances/tolerances.h"

namespace aureole {

/// One line a second at most for each kind, peer and direction; how many more there were stands in
/// the next one.
class ToleranceLog {
 public:
  /// The world begins here, or this server in it. For a second steps and links find their pace:
  /// what is outside then counts as anywhere else, and is told only if it still is when that second
  /// ends.
  void begin(Tick now);
  /// Logs what is to be told of what has happened up to `now`.
  void add(Tick now, std::span<const ToleranceEvent> events);

  struct Line {
    bool outside = false;
    std::string text;
  };
  std::vector<Line> lines(Tick now, std::span<const ToleranceEvent> events);
  /// The line for an event, or nothing if it is too soon for another one.
  std::string line(const ToleranceEvent& event);

 private:
  struct Said {
    Tick at;
    std::uint64_t unsaid = 0;
  };
  std::map<std::tuple<ToleranceEvent::Kind, RegionId, bool>, Said> said_;
  Tick told_from_;
  /// The newest of each kind and peer while nothing is told.
  std::map<std::pair<ToleranceEvent::Kind, RegionId>, ToleranceEvent> held_;
};

}  // namespace aureole
