// Sentences about tolerances, and a bound on how many.
#include "server/net/tolerance_log.h"

#include <spdlog/spdlog.h>

namespace aureole {
namespace {

constexpr std::int64_t pause_ticks = 1'000'000 / tick_us;

std::string what(const ToleranceEvent& e) {
  switch (e.kind) {
    case ToleranceEvent::Kind::speed:
      return fmt::format("speed: body {} moves at {:.1f} m/s", e.body.value, e.value);
    case ToleranceEvent::Kind::latency:
      return fmt::format("latency: messages of r{} take {:.1f} ms", e.peer.value, e.value);
    case ToleranceEvent::Kind::frame_time:
      return fmt::format("frame time: a step was done {:.1f} ms after its tick", e.value);
    case ToleranceEvent::Kind::link:
      return fmt::format("link: the newest word of r{} is {:.0f} ticks old", e.peer.value, e.value);
  }
  return {};
}

}  // namespace

std::string ToleranceLog::line(const ToleranceEvent& event) {
  const auto key = std::tuple(event.kind, event.peer, event.outside);
  const auto [it, first] = said_.try_emplace(key, Said{event.tick, 0});
  Said& said = it->second;
  if (!first && event.tick - said.at < pause_ticks) {
    ++said.unsaid;
    return {};
  }
  // A link that is lost is outside at once, however new its last word.
  const bool lost =
      event.kind == ToleranceEvent::Kind::link && event.outside && event.value <= event.limit;
  std::string line = fmt::format("{} its tolerance at tick {}, ",
                                 event.outside ? "outside" : "back inside", event.tick.value);
  line += lost ? fmt::format("link: r{} is lost", event.peer.value)
               : fmt::format("{}; at most {:g}", what(event), event.limit);
  if (said.unsaid > 0) line += fmt::format(" ({} more times before that)", said.unsaid);
  said = {event.tick, 0};
  return line;
}

void ToleranceLog::begin(Tick now) {
  told_from_ = now + pause_ticks;
}

std::vector<ToleranceLog::Line> ToleranceLog::lines(Tick now,
                                                    std::span<const ToleranceEvent> events) {
  std::vector<Line> lines;
  if (now < told_from_) {
    for (const ToleranceEvent& event : events)
      held_.insert_or_assign({event.kind, event.peer}, event);
    return lines;
  }
  const auto tell = [&](const ToleranceEvent& event) {
    if (std::string text = line(event); !text.empty())
      lines.push_back({event.outside, std::move(text)});
  };
  for (const auto& [of, event] : std::exchange(held_, {}))
    if (event.outside) tell(event);
  for (const ToleranceEvent& event : events) tell(event);
  return lines;
}

void ToleranceLog::add(Tick now, std::span<const ToleranceEvent> events) {
  for (const Line& line : lines(now, events)) {
    if (line.outside)
      spdlog::warn("{}", line.text);
    else
      spdlog::info("{}", line.text);
  }
}

}  // namespace aureole
