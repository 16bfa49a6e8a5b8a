// Checked number by number.
#include "server/region/status/status_message.h"

#include <cmath>

#include "protocol/wire.h"

namespace aureole {
namespace {

Status read_outside(const wire::RegionStatus& status, std::size_t regions,
                    std::vector<ToleranceEvent>& all) {
  if (status.outside() == nullptr) return Ok{};
  if (status.outside()->size() > ToleranceEvent::kinds)
    return Error::format("a region's status marks {} tolerances; there are {}",
                         status.outside()->size(), ToleranceEvent::kinds);
  for (const wire::ToleranceMark* mark : *status.outside()) {
    if (mark->kind() >= ToleranceEvent::kinds || mark->peer() >= regions)
      return Error::format(
          "a region's status marks a tolerance of kind {} and region {}; expected less than {} and "
          "{}",
          mark->kind(), mark->peer(), ToleranceEvent::kinds, regions);
    if (!is_wire_tick(mark->tick()) || !std::isfinite(mark->value()) ||
        !std::isfinite(mark->limit()))
      return Error::format("a region's status marks a tolerance of {} left with {} at tick {}",
                           mark->limit(), mark->value(), mark->tick());
    all.push_back({ToleranceEvent::Kind{mark->kind()},
                   true,
                   Tick{mark->tick()},
                   RegionId{mark->peer()},
                   {},
                   mark->value(),
                   mark->limit()});
  }
  return Ok{};
}

}  // namespace

Result<RegionStatusMessage> decode_status(std::span<const std::byte> payload, std::size_t regions) {
  const auto* told = verified<wire::RegionStatus>(payload);
  if (told == nullptr) return Error{"a region's status is not a valid message"};
  if (!is_wire_tick(told->tick()))
    return Error::format("a region's status of tick {}; expected at most {} from 0", told->tick(),
                         wire_tick_max);
  RegionStatusMessage status{.tick = Tick{told->tick()},
                             .level = {told->level(), told->next_level()}};
  RegionReport& report = status.report;
  if (auto read = read_outside(*told, regions, report.outside); !read) return read.error();
  auto lines = read_line_news(*told);
  if (!lines) return lines.error();
  status.lines = *lines;
  report.bodies = told->bodies();
  report.awake = told->awake();
  report.frame_ms_p50 = told->frame_us_p50() / 1e3;
  report.frame_ms_max = told->frame_us_max() / 1e3;
  report.migrations_in = told->migrations_in();
  report.migrations_out = told->migrations_out();
  report.overruns = told->overruns();
  report.skipped_ticks = told->skipped_ticks();
  report.removed_strays = told->removed_strays();
  report.unacknowledged = told->unacknowledged();
  report.tolerance_events = told->tolerance_events();
  report.missed_blows = told->missed_blows();
  report.whole_looks = told->whole_looks();
  report.recovering = told->recovering();
  return status;
}

}  // namespace aureole
