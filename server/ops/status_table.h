// The JSON of /api/status, read back and laid out for a terminal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace aureole {

/// A tolerance that a region does not keep now.
struct ToleranceMark {
  std::string tolerance;  ///< speed, latency, frame_time or link
  std::string peer;       ///< Empty for speed and frame time.
  std::int64_t since_tick = 0;
  double value = 0, limit = 0;
  std::string unit;
};

struct RegionStatus {
  std::string name;
  bool up = false;
  bool recovering = false;  ///< Linked, but it simulates nothing yet.
  std::int64_t bodies = 0, awake = 0;
  double frame_ms_p50 = 0, frame_ms_max = 0;
  std::int64_t migrations_in = 0, migrations_out = 0;
  std::int64_t skipped_ticks = 0;  ///< Left out since its start, because it was behind.
  std::int64_t missed_blows = 0;   ///< That reached only copies of others' resting bodies.
  std::vector<ToleranceMark> outside;
};

struct WorldStatus {
  double world_time_s = 0;
  std::int64_t bodies = 0, players = 0;
  std::vector<RegionStatus> regions;
};

/// Errors: not JSON, or a field is missing or of the wrong kind. Fields that it does not know are
/// left out, so that older clients can read newer gateways.
Result<WorldStatus> parse_world_status(const std::string& json);

/// By its name in the world, or by its number as r0, r1, …; null if there is none. A name goes
/// first.
const RegionStatus* find_region(const WorldStatus& status, const std::string& name);

/// Up and simulating.
bool all_up(const WorldStatus& status);

/// One line for the world, one for each region, columns aligned, and one for each tolerance that is
/// not kept, links towards regions that are down aside; ends with a line end.
std::string status_table(const WorldStatus& status);

}  // namespace aureole
