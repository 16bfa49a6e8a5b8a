// What a region says of itself now and then, as its peers and gateways take it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/base/result.h"
#include "server/base/tick.h"
#include "server/region/lines/line_news.h"
#include "server/region/loads/load_levels.h"
#include "server/region/tolerances/tolerances.h"

namespace aureole {

/// For operators; see RegionStatus in protocol/messages.fbs.
struct RegionReport {
  bool up = false;  ///< Linked: what the hearer knows, not what was said.
  std::uint32_t bodies = 0, awake = 0;
  double frame_ms_p50 = 0, frame_ms_max = 0;
  std::uint64_t migrations_in = 0, migrations_out = 0;
  std::uint64_t overruns = 0, skipped_ticks = 0, removed_strays = 0;
  std::uint32_t unacknowledged = 0;
  /// Tolerances that are not kept now, of each kind the worst; see Tolerances::outside().
  std::vector<ToleranceEvent> outside;
  std::uint64_t tolerance_events = 0;
  std::uint64_t missed_blows = 0, whole_looks = 0;
  bool recovering = false;  ///< Started again after a death; simulates nothing yet.
};

struct RegionStatusMessage {
  Tick tick;
  RegionReport report{};
  LoadLevels::Told level;  ///< By which servers take their order.
  LineNews lines{};
};

/// Of a world of so many regions. Errors: what cannot be read, ticks beyond is_wire_tick(),
/// tolerances of unknown kinds or regions or with numbers that are none, a crowd of another size.
Result<RegionStatusMessage> decode_status(std::span<const std::byte> payload, std::size_t regions);

}  // namespace aureole
