// What a status says of lines between regions.
#pragma once

#include <cstdint>

#include "protocol/wire.h"
#include "server/base/result.h"
#include "server/region/lines/crowd.h"
#include "server/region/loads/load_levels.h"

namespace aureole {

struct LineNews {
  LoadLevels::Told level;
  /// Only where lines go to quiet places: the level of the line that the region begins at, as far
  /// as is known there; who is awake near it; and what the line that it keeps will still bring.
  std::uint16_t level_below = LoadLevels::unknown;
  Crowd crowd_below{};
  std::int32_t gain = 0;
  double awake = 0;  ///< Bodies, here and now.
};

/// Of a status that has been verified. Errors: a crowd of another size.
Result<LineNews> read_line_news(const wire::RegionStatus& status);

}  // namespace aureole
