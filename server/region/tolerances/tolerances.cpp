// One judgement for every tolerance: left at once, held again after a while.
#include "server/region/tolerances/tolerances.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/check.h"

namespace aureole {
namespace {

/// A quarter of a second: as long as a status is apart from the next.
constexpr std::int64_t settle_ticks_min = 16;

/// By how much a tolerance is exceeded.
double excess(const ToleranceEvent& event) {
  return event.limit > 0 ? event.value / event.limit : event.value;
}

}  // namespace

std::string_view name_of(ToleranceEvent::Kind kind) {
  switch (kind) {
    case ToleranceEvent::Kind::speed:
      return "speed";
    case ToleranceEvent::Kind::latency:
      return "latency";
    case ToleranceEvent::Kind::frame_time:
      return "frame_time";
    case ToleranceEvent::Kind::link:
      return "link";
  }
  return "link";
}

Tolerances::Tolerances(const AuraTolerances& limits, RegionId self, std::size_t region_count)
    : self_(self), links_(region_count) {
  set_limits(limits);
}

Tolerances::Link& Tolerances::link(RegionId peer) {
  AUREOLE_CHECK(peer.value < links_.size() && peer != self_, "a peer is another region");
  return links_[peer.value];
}

void Tolerances::expect_word(RegionId peer, std::int64_t every_ticks) {
  AUREOLE_CHECK(every_ticks >= 1, "nobody says more than one word in a step");
  link(peer).word_every_ticks = every_ticks;
}

void Tolerances::set_limits(const AuraTolerances& limits) {
  limits_ = limits;
  flight_ticks_ = static_cast<std::int64_t>(steps_in_flight(limits));
  settle_ticks_ = std::max(3 * flight_ticks_ - 1, settle_ticks_min);
}

double Tolerances::longest_latency_ms() const {
  double longest_ms = 0;
  for (const Link& link : links_) longest_ms = std::max(longest_ms, link.estimate_ms);
  return longest_ms;
}

void Tolerances::link_up(RegionId peer) {
  Link& up = link(peer);
  up.up = true;
  up.counts = false;
}

void Tolerances::link_down(RegionId peer) {
  Link& down = link(peer);
  down.up = false;
  down.broke = true;
  // What the next link measures has nothing to do with this one.
  down.latency_ms.clear();
  take_estimate(down);
  down.measured_ms = -1;
}

void Tolerances::link_measured(RegionId peer, double latency_ms) {
  AUREOLE_CHECK(std::isfinite(latency_ms) && latency_ms >= 0, "a latency is a time");
  double& measured_ms = link(peer).measured_ms;
  measured_ms = std::max(measured_ms, latency_ms);
}

void Tolerances::heard(RegionId peer, Tick tick) {
  Link& from = link(peer);
  from.newest = from.counts ? std::max(from.newest, tick) : tick;
  from.counts = true;
}

void Tolerances::judge(Kept& kept, const ToleranceEvent& seen, bool exceeds) {
  if (exceeds) {
    kept.exceeded = seen.tick;
    if (!kept.outside) {
      kept.outside = true;
      kept.event = seen;
      kept.event.outside = true;
      events_.push_back(kept.event);
      ++left_count_;
    } else if (seen.value > kept.event.value) {
      kept.event.value = seen.value;
      kept.event.body = seen.body;
    }
    return;
  }
  if (!kept.outside || seen.tick - kept.exceeded < settle_ticks_) return;
  kept.outside = false;
  events_.push_back(seen);
}

void Tolerances::judge(Link& link, Kept& kept, const ToleranceEvent& seen, bool exceeds) {
  judge(kept, seen, exceeds);
  link.outside = link.latency.outside || link.word.outside;
}

void Tolerances::take_estimate(Link& link) {
  const auto& history = link.latency_ms;
  link.estimate_ms = history.empty() ? 0 : history.front().second;
  // The newest stays, however old it is: there is no better estimate.
  link.estimate_until =
      history.size() > 1 ? history.front().first + latency_window_ticks : never_ends;
}

void Tolerances::judge_latency(RegionId peer, Link& link, Tick now) {
  auto& history = link.latency_ms;
  if (link.measured_ms >= 0) {
    while (!history.empty() && history.back().second <= link.measured_ms) history.pop_back();
    history.emplace_back(now, link.measured_ms);
    link.measured_ms = -1;
    take_estimate(link);
  }
  while (now >= link.estimate_until) {
    history.pop_front();
    take_estimate(link);
  }
  const bool exceeds = link.estimate_ms > limits_.latency_ms;
  if (!exceeds && !link.outside) return;
  judge(link, link.latency,
        {ToleranceEvent::Kind::latency, false, now, peer, {}, link.estimate_ms, limits_.latency_ms},
        exceeds);
}

void Tolerances::judge_word(RegionId peer, Link& link, Tick now) {
  // A new link is given the time that a first word needs. While there is none, the age goes on.
  if (!link.counts && (link.up || !started_)) {
    link.newest = now - 1;
    link.counts = true;
  }
  // A clock that is ahead of ours, or a peer that claims to be, is no word from the future.
  link.newest = std::min(link.newest, now);
  const auto age = static_cast<double>(now - link.newest);
  const auto limit = static_cast<double>(flight_ticks_ + link.word_every_ticks - 1);
  const bool broke = std::exchange(link.broke, false);
  const bool exceeds = age > limit || !link.up || broke;
  if (!exceeds && !link.outside) return;
  judge(link, link.word, {ToleranceEvent::Kind::link, false, now, peer, {}, age, limit}, exceeds);
}

void Tolerances::step(Tick now, double frame_ms, const FastestBody& fastest) {
  AUREOLE_CHECK(!started_ || now > last_, "time goes forwards");
  events_.clear();
  judge(speed_,
        {ToleranceEvent::Kind::speed,
         false,
         now,
         {},
         fastest.body,
         fastest.speed_mps,
         limits_.speed_mps},
        fastest.speed_mps > limits_.speed_mps);
  const std::int64_t ticks = started_ ? now - last_ : 1;
  if (ticks > 1) frame_ms = std::max(frame_ms, static_cast<double>(ticks * tick_us) / 1e3);
  judge(frame_time_,
        {ToleranceEvent::Kind::frame_time, false, now, {}, {}, frame_ms, limits_.frame_time_ms},
        frame_ms > limits_.frame_time_ms);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const RegionId peer{static_cast<std::uint16_t>(i)};
    if (peer == self_) continue;
    judge_latency(peer, links_[i], now);
    judge_word(peer, links_[i], now);
  }
  last_ = now;
  started_ = true;
}

std::vector<ToleranceEvent> Tolerances::outside() const {
  std::vector<ToleranceEvent> all;
  const auto add = [&](const Kept& kept) {
    if (!kept.outside) return;
    const auto same = std::find_if(
        all.begin(), all.end(), [&](const ToleranceEvent& e) { return e.kind == kept.event.kind; });
    if (same == all.end())
      all.push_back(kept.event);
    else if (excess(kept.event) > excess(*same))
      *same = kept.event;
  };
  add(speed_);
  add(frame_time_);
  for (const Link& link : links_)
    if (link.outside) add(link.latency), add(link.word);
  std::sort(all.begin(), all.end(),
            [](const ToleranceEvent& a, const ToleranceEvent& b) { return a.kind < b.kind; });
  return all;
}

}  // namespace aureole
