// Channels as queues with times of arrival; a hold delays, a reset empties.
#include "server/experiment/network/simulated_network.h"

#include <algorithm>

namespace aureole {
namespace {

constexpr Micros ping_interval_us = 250'000;
/// A process that dies is missed by its peers this soon: the kernel closes its sockets.
constexpr Micros notice_us_max = 20'000;
/// A process that has started is linked this soon.
constexpr Micros dial_us_min = 5'000, dial_us_max = 60'000;
/// After something was late, its channel counts as disturbed for so long.
constexpr Micros late_memory_us = 20'000;

}  // namespace

SimulatedNetwork::SimulatedNetwork(int ends, NetworkTiming timing, std::uint64_t seed)
    : ends_(static_cast<std::size_t>(ends)),
      timing_(timing),
      random_(seed, 1),
      loss_(timing.loss_share, 2 * timing.latency_us, seed),
      running_(ends_),
      channels_(ends_ * ends_),
      links_(ends_ * ends_) {}

SimulatedNetwork::Link& SimulatedNetwork::link(End a, End b) {
  return links_[index(std::min(a, b)) * ends_ + index(std::max(a, b))];
}

const SimulatedNetwork::Link& SimulatedNetwork::link(End a, End b) const {
  return links_[index(std::min(a, b)) * ends_ + index(std::max(a, b))];
}

Micros SimulatedNetwork::transit_us() {
  const Micros less =
      timing_.jitter_us > 0 ? random_.below(static_cast<int>(timing_.jitter_us) + 1) : 0;
  return std::max<Micros>(0, timing_.latency_us - less);
}

void SimulatedNetwork::push(End from, End to, Item item) {
  Channel& c = channel(from, to);
  item.alone_us = item.ready_us;
  item.ready_us = std::max(item.ready_us, c.last_ready_us);
  c.last_ready_us = item.ready_us;
  item.what.from = from;
  c.items.push_back(std::move(item));
}

void SimulatedNetwork::start(End end, Incarnation incarnation, Micros now) {
  running_[index(end)] = incarnation;
  for (End other = 0; other < static_cast<End>(ends_); ++other) {
    if (other == end || !runs(other)) continue;
    if (now == 0)
      dial(other, end, now, true);
    else
      link(end, other).dial_at_us =
          now + dial_us_min + random_.below(static_cast<int>(dial_us_max - dial_us_min));
  }
}

void SimulatedNetwork::kill(End end, Micros now) {
  running_[index(end)].reset();
  for (End other = 0; other < static_cast<End>(ends_); ++other) {
    if (other == end) continue;
    break_link(end, other, now, end);
    link(end, other).dial_at_us = never;
    for (Channel* c : {&channel(end, other), &channel(other, end)}) c->ping = {};
    channel(other, end).items.clear();
    channel(end, other).known_generation = 0;
    channel(other, end).held_until_us = 0;
    channel(other, end).last_ready_us = 0;
    channel(other, end).taken_ready_us = 0;
  }
}

void SimulatedNetwork::break_link(End a, End b, Micros now, std::optional<End> dead) {
  Link& l = link(a, b);
  const bool was_up = l.up;
  l.up = false;
  ++l.generation;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    Channel& c = channel(from, to);
    const auto frames = std::erase_if(c.items, [](const Item& item) {
      return item.what.kind != Delivery::Kind::up && item.what.kind != Delivery::Kind::down;
    });
    frames_lost_ += frames;
    c.ping = {};
    c.unnoticed = 0;
    c.last_ready_us = c.items.empty() ? now : c.items.back().ready_us;
    if (!was_up || to == dead) continue;
    Item item;
    item.what.kind = Delivery::Kind::down;
    item.ready_us = item.sent_us = now + random_.below(static_cast<int>(notice_us_max));
    push(from, to, std::move(item));
  }
}

void SimulatedNetwork::reset(End a, End b, Micros now, Micros back_after_us) {
  if (!runs(a) || !runs(b)) return;
  break_link(a, b, now, {});
  link(a, b).dial_at_us = now + notice_us_max + back_after_us;
}

void SimulatedNetwork::dial(End a, End b, Micros now, bool at_once) {
  Link& l = link(a, b);
  l.dial_at_us = never;
  if (!runs(a) || !runs(b)) return;
  l.up = true;
  // The hello of the one that dials arrives first, and the other one's answer after it.
  const End listens = std::min(a, b), dials = std::max(a, b);
  Micros at = now;
  for (const auto& [from, to] : {std::pair(dials, listens), std::pair(listens, dials)}) {
    if (!at_once) at += transit_us();
    Item item;
    item.what.kind = Delivery::Kind::up;
    item.what.incarnation = *running_[index(from)];
    item.ready_us = item.sent_us = at;
    item.generation = l.generation;
    push(from, to, std::move(item));
  }
}

void SimulatedNetwork::send(End from, End to, SharedBytes frame, Micros now) {
  const Link& l = link(from, to);
  if (!l.up || channel(from, to).known_generation != l.generation) {
    ++frames_lost_;
    return;
  }
  Traffic& traffic = channel(from, to).traffic;
  ++traffic.messages;
  traffic.bytes += frame->size();
  if (watcher_) watcher_(from, to, frame);
  Item item;
  item.what.kind = Delivery::Kind::frame;
  item.what.frame = std::move(frame);
  item.sent_us = now;
  item.ready_us = now + transit_us();
  if (loss_.any()) lose(channel(from, to), item, now);
  push(from, to, std::move(item));
}

/// Draws what becomes of a frame; if it arrives, the sender learns of what was lost before.
void SimulatedNetwork::lose(Channel& c, Item& item, Micros now) {
  const PacketLoss::Fate fate = loss_.draw(item.what.frame->size());
  const Micros sent_again_us = now + timing_.latency_us + fate.again_us;
  if (!fate.last_lost && c.unnoticed > 0) {
    Micros ready_us = c.taken_ready_us;
    for (Item& before : c.items) {
      if (before.unnoticed)
        before.alone_us = std::min(
            before.alone_us, now + loss_.noticed_after_us() + timing_.latency_us + before.again_us);
      before.unnoticed = false;
      ready_us = std::max(ready_us, before.alone_us);
      before.ready_us = ready_us;
    }
    c.last_ready_us = ready_us;
    c.unnoticed = 0;
  }
  if (!fate.lost) return;
  ++frames_sent_again_;
  item.unnoticed = fate.last_lost;
  item.again_us = fate.again_us;
  c.unnoticed += fate.last_lost ? 1 : 0;
  item.ready_us = sent_again_us + (fate.last_lost ? loss_.timer_us() : loss_.noticed_after_us());
}

std::vector<Delivery> SimulatedNetwork::take(End to, Micros now) {
  std::vector<Delivery> taken;
  for (End from = 0; from < static_cast<End>(ends_); ++from) {
    if (from == to) continue;
    Channel& c = channel(from, to);
    if (c.held_until_us > now) continue;
    while (!c.items.empty() && c.items.front().ready_us <= now) {
      Item& item = c.items.front();
      item.what.arrived_us = std::max(item.ready_us, c.held_until_us);
      const Micros took_us = item.what.arrived_us - item.sent_us;
      const bool forgotten = now - c.late_at_us >= late_memory_us || c.late_at_us < 0;
      if (item.what.kind == Delivery::Kind::frame && took_us > timing_.latency_us &&
          (forgotten || took_us >= c.late_by_us)) {
        c.late_at_us = now;
        c.late_by_us = took_us;
      }
      // What this end sends from now on goes over the link that it has just learned of.
      if (item.what.kind == Delivery::Kind::up)
        channel(to, from).known_generation = item.generation;
      if (item.what.kind == Delivery::Kind::down) channel(to, from).known_generation = 0;
      if (item.unnoticed) --c.unnoticed;
      c.taken_ready_us = item.ready_us;
      taken.push_back(std::move(item.what));
      c.items.pop_front();
    }
  }
  std::stable_sort(taken.begin(), taken.end(), [](const Delivery& a, const Delivery& b) {
    return a.arrived_us < b.arrived_us;
  });
  return taken;
}

void SimulatedNetwork::stall(End from, End to, Micros until) {
  Channel& c = channel(from, to);
  c.held_until_us = std::max(c.held_until_us, until);
}

void SimulatedNetwork::advance(Micros now) {
  const bool ping = now >= next_ping_us_;
  if (ping) next_ping_us_ = now + ping_interval_us;
  for (End a = 0; a < static_cast<End>(ends_); ++a) {
    for (End b = a + 1; b < static_cast<End>(ends_); ++b) {
      Link& l = link(a, b);
      if (l.dial_at_us <= now) dial(a, b, now, false);
      if (!l.up || b + 1 == static_cast<End>(ends_)) continue;  // Nobody measures the gateway.
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        Channel& c = channel(from, to);
        if (ping && !c.ping.under_way && c.known_generation == l.generation)
          c.ping = {true, false, now, now + transit_us(), now, 0};
        if (c.ping.under_way) advance_ping(from, to, now);
      }
    }
  }
}

void SimulatedNetwork::advance_ping(End from, End to, Micros now) {
  Ping& ping = channel(from, to).ping;
  // Out over the one channel, back over the other; each may be held.
  if (!ping.returning) {
    if (waits_behind_loss(channel(from, to), ping, now)) return;
    const Micros out =
        std::max({ping.ready_us, channel(from, to).held_until_us, std::min(ping.behind_us, now)});
    if (out > now) return;
    ping.returning = true;
    ping.left_us = out;
    ping.ready_us = out + transit_us();
    ping.behind_us = 0;
  }
  if (waits_behind_loss(channel(to, from), ping, now)) return;
  const Micros back =
      std::max({ping.ready_us, channel(to, from).held_until_us, std::min(ping.behind_us, now)});
  if (back > now) return;
  ping.under_way = false;
  Item item;
  item.what.kind = Delivery::Kind::measured;
  item.what.latency_ms = static_cast<double>(back - ping.sent_us) / 2e3;
  item.sent_us = item.ready_us = back;
  push(to, from, std::move(item));
}

/// Frames that left before the ping arrive before it.
bool SimulatedNetwork::waits_behind_loss(const Channel& c, Ping& ping, Micros now) const {
  if (!loss_.any() || c.items.empty()) return false;
  const Item& first = c.items.front();
  if (first.sent_us > ping.left_us || first.ready_us <= now) return false;
  // May still become earlier.
  ping.behind_us = first.ready_us;
  return true;
}

bool SimulatedNetwork::is_disturbed(End a, End b, Micros now, Micros limit_us) const {
  if (!link(a, b).up || timing_.latency_us > limit_us) return true;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    const Channel& c = channel(from, to);
    if (c.held_until_us > now) return true;
    if (!c.items.empty() && now - c.items.front().sent_us > limit_us &&
        c.items.front().ready_us > now)
      return true;
    if (c.late_at_us >= 0 && c.late_by_us > limit_us && now - c.late_at_us < late_memory_us)
      return true;
    if (c.known_generation != link(a, b).generation) return true;
  }
  return false;
}

}  // namespace aureole
